//! The examples of the gallery, in the order of its cards.

/// An example of the gallery. It writes its page `NAME/NAME.html` into the folder of the option
/// `--out`, and its film `NAME/play.html`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exhibit {
    /// Name of the program.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// Question or content of the page, in a sentence.
    pub(crate) text: &'static str,
    /// Options of the program, besides the folder.
    pub(crate) options: &'static [&'static str],
    pub(crate) thumbnail: Thumbnail,
    /// Page and film of a program whose option `--out` is its own folder.
    pub(crate) own_files: Option<[&'static str; 2]>,
    /// The program shows times, which others beside it would increase.
    pub(crate) measures_times: bool,
}

/// Picture of a card.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Thumbnail {
    /// Film that starts at this fraction of its length.
    Film(f64),
    /// File of a drawing.
    Drawing(&'static str),
}

impl Exhibit {
    const fn new(
        name: &'static str,
        title: &'static str,
        text: &'static str,
        thumbnail: Thumbnail,
    ) -> Self {
        Self {
            name,
            title,
            text,
            options: &[],
            thumbnail,
            own_files: None,
            measures_times: false,
        }
    }

    const fn film(name: &'static str, title: &'static str, text: &'static str, start: f64) -> Self {
        Self::new(name, title, text, Thumbnail::Film(start))
    }

    const fn drawing(
        name: &'static str,
        title: &'static str,
        text: &'static str,
        file: &'static str,
    ) -> Self {
        Self::new(name, title, text, Thumbnail::Drawing(file))
    }

    const fn timed(self) -> Self {
        Self {
            measures_times: true,
            ..self
        }
    }

    const fn with_options(self, options: &'static [&'static str]) -> Self {
        Self { options, ..self }
    }

    const fn with_own_files(self, page: &'static str, film: &'static str) -> Self {
        Self {
            own_files: Some([page, film]),
            ..self
        }
    }

    /// Path of the page in the folder of the gallery.
    pub(crate) fn page(&self) -> String {
        let name = self.name;
        match self.own_files {
            Some([page, _]) => format!("{name}/{page}"),
            None => format!("{name}/{name}.html"),
        }
    }

    /// Path of the film in the folder of the gallery.
    pub(crate) fn play(&self) -> String {
        let film = self.own_files.map_or("play.html", |[_, film]| film);
        format!("{}/{film}", self.name)
    }
}

/// Options of all examples that the gallery shows.
const EXHIBITS: [Exhibit; 18] = [
    Exhibit::film(
        "coin",
        "The coin of the coin report",
        "A ring rolls, tumbles and comes to rest: the eight trials of the report.",
        0.01,
    )
    .with_options(&["--all", "--quiet", "--no-audit"])
    .with_own_files("overview.html", "trial-1/coin.html"),
    Exhibit::film(
        "dice",
        "Dice",
        "Is the die fair? Thousands of throws of a fair die and of a loaded one.",
        0.2,
    ),
    Exhibit::film(
        "dice_tray",
        "Dice in a tray",
        "Five dice are thrown against the walls of a tray: a ground of five surfaces.",
        0.4,
    )
    .with_options(&["--quick"]),
    Exhibit::film(
        "tippe_top",
        "Tippe top",
        "A sphere whose centre of mass lies low turns upside down.",
        0.1,
    ),
    Exhibit::film(
        "custom_body",
        "Rattleback",
        "A stone that is spun in the wrong direction reverses. A body of your own.",
        0.05,
    ),
    Exhibit::film(
        "rising_egg",
        "Rising egg",
        "A spheroid that is spun on its side rises onto its end.",
        0.1,
    ),
    Exhibit::film(
        "eulers_disk",
        "Euler's disk",
        "By which power of time does a spinning ring come to rest?",
        0.3,
    ),
    Exhibit::film(
        "slide_to_roll",
        "From sliding to rolling",
        "Balls start sliding and come to roll. One with backspin comes back.",
        0.2,
    ),
    Exhibit::film(
        "tennis",
        "Tennis",
        "What do topspin, slice and air do to serves and ground strokes?",
        0.3,
    ),
    Exhibit::film(
        "sphere_with_spin",
        "A ball with spin",
        "A tennis ball bounces with topspin, without spin and with backspin.",
        0.1,
    ),
    Exhibit::film(
        "bounces",
        "The bounces of a ball",
        "When does a dropped ball bounce, and how does it sound?",
        0.05,
    ),
    Exhibit::film(
        "custom_ground",
        "Beads in a valley",
        "Every oscillation in a cycloid has the same period. A ground of your own.",
        0.02,
    ),
    Exhibit::drawing(
        "heads_or_tails",
        "Heads or tails?",
        "Does the lean at the start bias the face on which a coin ends?",
        "lean.svg",
    )
    .with_options(&["--quick"]),
    Exhibit::film(
        "tosses",
        "Any toss of a million",
        "Tosses have the same result on any machine. Each is replayed by its number.",
        0.05,
    )
    .with_options(&["--toss", "123456"])
    .with_own_files("play.html", "play.html"),
    Exhibit::drawing(
        "measured_tosses",
        "Tosses of a cube, fitted",
        "Does a fit find the parameters with which noisy tosses were made?",
        "toss.svg",
    )
    .with_options(&["--synthetic"]),
    Exhibit::drawing(
        "round_rim",
        "Round rim or points?",
        "Coins with 12, 120 and 1200 points on the rim, and one with a round rim.",
        "rattle.svg",
    ),
    Exhibit::drawing(
        "accuracy",
        "Error and step size",
        "Every integrator on trial 1 of the coin report, against an exact solution.",
        "error.svg",
    )
    .with_options(&["--page"]),
    Exhibit::drawing(
        "choose_accuracy",
        "Error and cost",
        "Which integrator has an error of 0.1 mm at the lowest cost?",
        "work_precision.svg",
    )
    .with_options(&["--quick"])
    .timed(),
];

/// Manifest of the examples, which names all of them.
const MANIFEST: &str = include_str!("../Cargo.toml");

/// Examples without a page: the gallery itself, and one whose tables are in the guide.
const WITHOUT_PAGE: [&str; 2] = ["gallery", "known_outcomes"];

/// Returns all examples of the manifest that write a page. One that is not in the list above comes
/// last, with its name as the title.
pub(crate) fn all() -> Vec<Exhibit> {
    let mut all = EXHIBITS.to_vec();
    let names = MANIFEST.split("[[example]]\nname = \"").skip(1);
    for name in names.filter_map(|rest| rest.split('"').next()) {
        if !WITHOUT_PAGE.contains(&name) && all.iter().all(|exhibit| exhibit.name != name) {
            all.push(Exhibit::film(name, name, "", 0.2));
        }
    }
    all
}
