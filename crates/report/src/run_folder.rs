//! Files of a run, as they are found.
use crate::error::ReportError;
use crate::pictures::{self, Listed};
use crate::run_table::RunTable;
use serde_json::Value;
use std::io;
use std::path::{Path, PathBuf};

/// Bytes of the scene's text on the page.
const MOST_TEXT: usize = 200_000;

/// A run's folder. What is missing although the run writes it, or is damaged, is in the notes.
#[derive(Debug)]
pub(crate) struct RunFolder {
    /// The folder as given.
    pub(crate) folder: PathBuf,
    /// Name on pages of several runs.
    pub(crate) label: String,
    /// `plan.json`, `result.json`, `timings.json`; null if absent.
    pub(crate) plan: Value,
    pub(crate) result: Value,
    pub(crate) timings: Value,
    /// Text of the scene file.
    pub(crate) scene: Option<String>,
    /// Lines of the log.
    pub(crate) log: Vec<String>,
    pub(crate) history: Option<RunTable>,
    pub(crate) residuals: Option<RunTable>,
    pub(crate) trajectories: Option<RunTable>,
    pub(crate) forces: Option<RunTable>,
    /// Means over time and two axes.
    pub(crate) profile: Option<RunTable>,
    /// Tables of probes by name.
    pub(crate) probes: Vec<(String, RunTable)>,
    pub(crate) pictures: Vec<Listed>,
    pub(crate) notes: Vec<String>,
}

/// Reads files and notes what is missing.
struct Files<'a> {
    folder: &'a Path,
    notes: Vec<String>,
}

impl Files<'_> {
    /// Text of a file; none with a note if it is not there although `expected`, or cannot be read.
    fn text(&mut self, name: &str, expected: Option<&str>) -> Option<String> {
        match std::fs::read(self.folder.join(name)) {
            Ok(bytes) => Some(String::from_utf8_lossy(&bytes).into_owned()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                if let Some(meaning) = expected {
                    self.notes.push(format!("{name} is not there: {meaning}"));
                }
                None
            }
            Err(error) => {
                self.notes.push(format!("{name} cannot be read: {error}"));
                None
            }
        }
    }

    fn json(&mut self, name: &str, meaning: &str) -> Value {
        let Some(text) = self.text(name, Some(meaning)) else { return Value::Null };
        serde_json::from_str(&text).unwrap_or_else(|error| {
            self.notes.push(format!("{name} is damaged ({error}) and left out"));
            Value::Null
        })
    }

    /// A table that the run writes if `listed`; without a list of tables, one that may be there.
    fn table(&mut self, name: &str, listed: Option<&[String]>) -> Option<RunTable> {
        let expected = listed.map(|tables| tables.iter().any(|table| table == name));
        if expected == Some(false) {
            if self.folder.join(name).exists() {
                self.notes.push(format!(
                    "{name} is not a table of this run (plan.json) but of an earlier one, and left out"
                ));
            }
            return None;
        }
        match RunTable::read(&self.folder.join(name)) {
            Ok(table) => {
                self.notes.extend(table.note(name));
                if table.is_empty() {
                    self.notes.push(format!("{name} has no rows"));
                }
                Some(table)
            }
            Err(error) => {
                let exists = self.folder.join(name).exists();
                match expected {
                    Some(_) if !exists => {
                        self.notes.push(format!("{name} is not there, although the run writes it"))
                    }
                    _ if exists => self.notes.push(format!("{name} cannot be read: {error}")),
                    _ => {}
                }
                None
            }
        }
    }
}

impl RunFolder {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// [`ReportError::Folder`], [`ReportError::NotARun`].
    pub(crate) fn read(folder: &Path) -> Result<Self, ReportError> {
        std::fs::read_dir(folder).map_err(|source| ReportError::Folder { folder: folder.into(), source })?;
        let mut files = Files { folder, notes: Vec::new() };
        let plan = files.json("plan.json", "the run was made by a version that does not write it; scheme, warnings and tables are known as far as the other files tell");
        let result = files.json("result.json", "the run has not come to its end, or ended by an error");
        if plan.is_null() && result.is_null() {
            return Err(ReportError::NotARun(folder.into()));
        }
        let meaning = (!result.is_null()).then_some("there is no cost");
        let timings = match meaning {
            Some(meaning) => files.json("timings.json", meaning),
            None => Value::Null,
        };
        let mut scene = files.text("scene.toml", Some("the scene's text is unknown"));
        if let Some(text) = &mut scene
            && text.len() > MOST_TEXT
        {
            let end = (0..=MOST_TEXT).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
            files
                .notes
                .push(format!("scene.toml has {} bytes, of which the first {end} are shown", text.len()));
            text.truncate(end);
        }
        let log = files.text("run.log", Some("how the run went is unknown"));
        let log: Vec<String> = log.iter().flat_map(|text| text.lines()).map(str::to_owned).collect();
        let listed: Option<Vec<String>> = plan["tables"]
            .as_array()
            .map(|tables| tables.iter().filter_map(Value::as_str).map(str::to_owned).collect());
        let listed = listed.as_deref();
        let steady = plan["steady"].as_bool().unwrap_or(result.get("iterations").is_some());
        let history = files.table("history.csv", listed);
        let residuals = files.table("residuals.csv", listed);
        let trajectories = files.table("trajectories.csv", listed);
        let forces = if steady { None } else { files.table("forces.csv", listed) };
        // It is written at the end.
        let done = result["complete"] == true;
        let profile = if done { files.table("profile.csv", listed) } else { None };
        let of_result = || -> Vec<String> {
            let names = result["probes"].as_array().into_iter().flatten();
            names.filter_map(|p| Some(format!("probes/{}.csv", p["name"].as_str()?))).collect()
        };
        let names: Vec<String> = match listed {
            Some(tables) => tables.iter().filter(|t| t.starts_with("probes/")).cloned().collect(),
            None => of_result(),
        };
        let probe = |name: String, files: &mut Files<'_>| {
            let table = files.table(&name, None);
            if table.is_none() && !steady && !folder.join(&name).exists() {
                files.notes.push(format!("{name} is not there, although the run writes it"));
            }
            Some((name.trim_start_matches("probes/").trim_end_matches(".csv").to_owned(), table?))
        };
        let probes = if steady {
            Vec::new()
        } else {
            names.into_iter().filter_map(|name| probe(name, &mut files)).collect()
        };
        let wants_pictures = listed.is_none_or(|tables| tables.iter().any(|table| table == "images.csv"));
        let index =
            if listed.is_some() { picture_index(folder, wants_pictures, &mut files.notes) } else { None };
        let pictures = if wants_pictures {
            pictures::list(folder, index.as_deref(), steady, &mut files.notes)
        } else {
            Vec::new()
        };
        let label = folder
            .file_name()
            .map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned());
        Ok(Self {
            folder: folder.into(),
            label,
            plan,
            result,
            timings,
            scene,
            log,
            history,
            residuals,
            trajectories,
            forces,
            profile,
            probes,
            pictures,
            notes: files.notes,
        })
    }

    /// The value under `key` of the results, or of the plan.
    pub(crate) fn value(&self, key: &str) -> &Value {
        match self.result.get(key) {
            Some(value) => value,
            None => &self.plan[key],
        }
    }

    pub(crate) fn title(&self) -> &str {
        self.value("title").as_str().unwrap_or(&self.label)
    }

    pub(crate) fn is_steady(&self) -> bool {
        self.plan["steady"].as_bool().unwrap_or(self.result.get("iterations").is_some())
    }

    /// Number of axes.
    pub(crate) fn dim(&self) -> usize {
        self.cells().len()
    }

    /// Cells along the axes.
    pub(crate) fn cells(&self) -> Vec<u64> {
        self.value("cells").as_array().into_iter().flatten().filter_map(Value::as_u64).collect()
    }

    /// Edge lengths of the box \[m\]; empty if unknown.
    pub(crate) fn size(&self) -> Vec<f64> {
        self.plan["size"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
    }

    /// Warnings of the plan, of the run and of its results, each once.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let logged = self.log.iter().filter_map(|line| Some(line.split_once(" warning: ")?.1.to_owned()));
        let list = |value: &Value| -> Vec<String> {
            value.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        let deep = self.result["deepest_overlap"]["warning"].as_str().map(str::to_owned);
        let mut all: Vec<String> = list(&self.plan["warnings"]);
        for one in logged.chain(list(&self.result["y_plus"]["warnings"])).chain(deep) {
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    /// End of the run: whether it is complete, and a sentence.
    pub(crate) fn ending(&self) -> (bool, String) {
        let at =
            |value: &Value, unit: &str| value.as_f64().map(|x| format!("{}{unit}", crate::text::number(x)));
        let r = &self.result;
        if r.is_null() {
            let error =
                self.log.iter().rev().find_map(|line| Some(line.split_once("ended by an error: ")?.1));
            return (
                false,
                match error {
                    Some(error) => format!("ended by an error: {error}"),
                    None => "not at its end: still running, killed, or ended by an error (there is no result.json)".into(),
                },
            );
        }
        let reached = match (at(&r["time"], " s"), at(&r["residual"], "")) {
            (Some(time), _) => format!("at t = {time} after {} steps", r["steps"]),
            (None, Some(residual)) => format!("after {} iterations, residual {residual}", r["iterations"]),
            (None, None) => String::new(),
        };
        match r["ending"].as_str() {
            Some("done") if self.is_steady() => (true, format!("converged {reached}")),
            Some("done") => (true, format!("done {reached}")),
            Some("steady") => (true, format!("steady {reached}")),
            Some("event") => (true, format!("ended by the event of time.stop {reached}")),
            Some("stopped") => (false, format!("stopped {reached}; `siltflow resume` goes on")),
            Some(other) => (false, format!("{other} {reached}")),
            None if r["complete"] == true => (true, format!("complete {reached}")),
            None => (false, format!("not complete {reached}")),
        }
    }

    /// Factor from the load on a body \[N\] to its coefficient.
    pub(crate) fn coefficient(&self, body: &str) -> Option<f64> {
        let bodies = self.result["forces"].as_array()?;
        bodies.iter().find(|b| b["body"] == body)?["coefficient_per_newton"].as_f64()
    }
}

/// Rows of `images.csv`: file and time.
fn picture_index(folder: &Path, expected: bool, notes: &mut Vec<String>) -> Option<Vec<(String, f64)>> {
    if !expected {
        return None;
    }
    let reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).from_path(folder.join("images.csv"));
    let mut reader = match reader {
        Ok(reader) => reader,
        Err(error) => {
            notes.push(format!("images.csv cannot be read ({error}): pictures of an earlier run may be among those in images/"));
            return None;
        }
    };
    let rows = reader.records().filter_map(|row| {
        let row = row.ok()?;
        Some((row.get(1)?.to_owned(), row.get(0)?.parse().ok()?))
    });
    Some(rows.collect())
}
