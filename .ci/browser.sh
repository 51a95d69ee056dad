# Installs Chromium by Debian's packages into the system, and the program that drives it into the folder $work. Sets CHROMIUM.
# Where they cannot be had, it says so and ends the script with success: nothing is checked.
# To be sourced, from the top folder.
. .ci/debian.sh
driver=25.16.0
browser() { command -v chromium || command -v chromium-browser || command -v google-chrome; }
if ! browser >/dev/null && ! debian_install chromium >"$work/apt.log" 2>&1; then
  echo "NOT CHECKED: Chromium cannot be installed on this machine"
  exit 0
fi
installed() { grep -qs "\"version\": \"$driver\"" "$work/node_modules/puppeteer-core/package.json"; }
if ! installed && ! PUPPETEER_SKIP_DOWNLOAD=1 npm install --silent --no-save --prefix "$work" "puppeteer-core@$driver" >"$work/npm.log" 2>&1; then
  echo "NOT CHECKED: puppeteer-core cannot be installed on this machine"
  exit 0
fi
CHROMIUM=$(browser)
export CHROMIUM
