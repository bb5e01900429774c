//! Columns of numbers over time, from CSV files.

/// Columns of a CSV file over its column `time` \[s\], interpolated linearly.
#[derive(Clone, Debug)]
pub(crate) struct TimeTable {
    times: Vec<f64>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

/// Share of the span of times by which its ends are passed at most: round-off of the clock.
const ROUND_OFF: f64 = 1e-9;

impl TimeTable {
    /// Parses a header with the names of the columns, one of them `time`, and at least two rows in
    /// order of time. Lines that are empty or begin with # are comments.
    ///
    /// # Errors
    /// The line, the value and the remedy.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| {
            let line = line.trim();
            !line.is_empty() && !line.starts_with('#')
        });
        let header = lines.next().map_or("", |(_, line)| line);
        let mut names: Vec<String> = header.split(',').map(|name| name.trim().to_owned()).collect();
        let Some(time) = names.iter().position(|name| name == "time") else {
            return Err(format!(
                "the first line is \"{header}\"; give names of columns, separated by commas, one of them time"
            ));
        };
        let mut columns = vec![Vec::new(); names.len()];
        for (number, line) in lines {
            let values: Vec<&str> = line.split(',').map(str::trim).collect();
            if values.len() != names.len() {
                return Err(format!(
                    "line {number} has {} values; give {}, one for each column",
                    values.len(),
                    names.len()
                ));
            }
            for ((column, name), value) in columns.iter_mut().zip(&names).zip(values) {
                match value.parse::<f64>() {
                    Ok(x) if x.is_finite() => column.push(x),
                    _ => return Err(format!("{name} is \"{value}\" in line {number}; give a finite number")),
                }
            }
            if let [.., before, last] = columns[time][..]
                && last <= before
            {
                return Err(format!(
                    "the time is {last} s in line {number}, after {before} s; give rows in order of time"
                ));
            }
        }
        names.remove(time);
        let times = columns.remove(time);
        if times.len() < 2 {
            return Err(format!("there are {} rows; give two at least", times.len()));
        }
        Ok(Self { times, names, columns })
    }

    /// Names of the columns other than the time.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// First and last time \[s\].
    pub(crate) fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    fn slack(&self) -> f64 {
        let [first, last] = self.span();
        ROUND_OFF * (last - first)
    }

    /// Whether there are values from 0 to `end` \[s\].
    pub(crate) fn covers(&self, end: f64) -> bool {
        let ([first, last], slack) = (self.span(), self.slack());
        first <= slack && last >= end - slack
    }

    /// Value of the column with this number at `time` \[s\], by linear interpolation; not a number
    /// beyond the ends.
    pub(crate) fn at(&self, column: usize, time: f64) -> f64 {
        let ([first, last], slack) = (self.span(), self.slack());
        let Some(values) = self.columns.get(column) else { return f64::NAN };
        if !(first - slack..=last + slack).contains(&time) {
            return f64::NAN;
        }
        let next = self.times.partition_point(|t| *t <= time).clamp(1, self.times.len() - 1);
        let [from, to] = [self.times[next - 1], self.times[next]];
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        values[next - 1] * (1.0 - share) + values[next] * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_interpolated_linearly_between_their_ends() {
        let table = TimeTable::parse("# u in m/s\nu, time\n1.0, 0\n\n3.0, 0.5\n2.0, 1.5\n").unwrap();
        assert_eq!((table.names(), table.span()), (&["u".to_owned()][..], [0.0, 1.5]));
        for (time, value) in [(0.0, 1.0), (0.25, 2.0), (0.5, 3.0), (1.0, 2.5), (1.5, 2.0)] {
            assert!((table.at(0, time) - value).abs() < 1e-15, "{time}");
        }
        assert!(table.at(0, 1.6).is_nan() && table.at(0, -0.1).is_nan() && table.at(1, 0.5).is_nan());
        assert!(table.covers(1.5) && !table.covers(1.6));
    }

    #[test]
    fn faults_are_named_with_their_line() {
        for (text, part) in [
            ("", "one of them time"),
            ("u,v\n0,1\n", "one of them time"),
            ("time,u\n0,1\n1\n", "line 3 has 1 values; give 2"),
            ("time,u\n0,1\n1,x\n", "u is \"x\" in line 3"),
            ("time,u\n0,1\n1,inf\n", "finite"),
            ("time,u\n0,1\n0,1\n", "order of time"),
            ("time,u\n0,1\n", "two at least"),
        ] {
            let error = TimeTable::parse(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
