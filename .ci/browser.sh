# Installs Chromium, Node and npm by Debian's packages into the system, and the program that drives it into the folder $work. Sets CHROMIUM.
# Where they cannot be had, it says so and ends the script with success: nothing is checked.
# To be sourced, from the top folder.
. .ci/debian.sh
driver=25.16.0
browser() { command -v chromium || command -v chromium-browser || command -v google-chrome; }
browser_tools() {
  local missing=()
  browser >/dev/null || missing+=(chromium)
  command -v node >/dev/null || missing+=(nodejs)
  command -v npm >/dev/null || missing+=(npm)
  [ ${#missing[@]} = 0 ] || debian_install "${missing[@]}" >"$work/apt.log" 2>&1
}
if ! browser_tools; then
  echo "NOT CHECKED: Chromium, Node or npm cannot be installed on this machine"
  exit 0
fi
installed() { grep -qs "\"version\": \"$driver\"" "$work/node_modules/puppeteer-core/package.json"; }
if ! installed && ! PUPPETEER_SKIP_DOWNLOAD=1 npm install --silent --no-save --prefix "$work" "puppeteer-core@$driver" >"$work/npm.log" 2>&1; then
  echo "NOT CHECKED: puppeteer-core cannot be installed on this machine"
  exit 0
fi
CHROMIUM=$(browser)
export CHROMIUM
