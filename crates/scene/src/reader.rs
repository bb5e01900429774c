//! Values of a document that has been checked.
use crate::document::{Item, Place, Section, Value};
use crate::expression::Expression;
use crate::problem::{Problem, shown};
use crate::schema::{number, whole};
use interfaces::{Point, Vector};
use std::cell::RefCell;

/// A formula of the file.
#[derive(Clone, Debug)]
pub(crate) struct Formula {
    pub(crate) path: String,
    pub(crate) place: Place,
    pub(crate) text: String,
    pub(crate) variables: Vec<String>,
    pub(crate) expression: Expression,
}

impl Formula {
    /// Where it had no finite value, if there was such a place or time.
    pub(crate) fn problem(&self) -> Option<Problem> {
        let (given, value) = self.expression.fault()?;
        let at = self.variables.iter().zip(given).map(|(name, x)| format!("{name} = {x:.6}"));
        let message = format!(
            "the formula {} is {value} at {}; give one that is finite all over the box and until the end",
            shown(&self.text),
            at.collect::<Vec<_>>().join(", ")
        );
        Some(Problem::new(self.path.clone(), self.place.clone(), message))
    }
}

impl Formula {
    /// Whether its value depends on a variable of this name.
    pub(crate) fn uses(&self, variable: &str) -> bool {
        self.variables.iter().position(|v| v == variable).is_some_and(|v| self.expression.uses(v))
    }
}

/// All formulas that were read.
pub(crate) type Formulas = RefCell<Vec<Formula>>;

/// A table, to be read key by key. What the schema has checked is taken as it is; a value of another kind counts as absent.
#[derive(Clone, Debug)]
pub(crate) struct Reader<'a> {
    section: &'a Section,
    place: Place,
    path: String,
    formulas: &'a Formulas,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(
        section: &'a Section,
        place: Place,
        path: impl Into<String>,
        formulas: &'a Formulas,
    ) -> Self {
        Self { section, place, path: path.into(), formulas }
    }

    /// What is wrong with `key`, or with the table if it is not there.
    pub(crate) fn fail(&self, key: &str, message: impl ToString) -> Problem {
        let place = self.section.get(key).map_or(&self.place, |item| &item.place);
        Problem::new(self.path_of(key), place.clone(), message.to_string())
    }
    /// What is wrong with the table.
    pub(crate) fn fail_here(&self, message: impl ToString) -> Problem {
        Problem::new(self.path.clone(), self.place.clone(), message.to_string())
    }
    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) }
    }

    /// The first formula of the file, as far as it has been read, for which `holds` holds.
    pub(crate) fn find_formula(&self, holds: impl Fn(&Formula) -> bool) -> Option<Formula> {
        self.formulas.borrow().iter().find(|f| holds(f)).cloned()
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.section.get(key).is_some()
    }
    fn value(&self, key: &str) -> Option<&'a Value> {
        self.section.get(key).map(|item| &item.value)
    }
    pub(crate) fn flag(&self, key: &str) -> Option<bool> {
        if let Value::Flag(flag) = self.value(key)? { Some(*flag) } else { None }
    }
    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        number(self.value(key)?)
    }
    pub(crate) fn whole(&self, key: &str) -> Option<usize> {
        whole(self.value(key)?).and_then(|n| usize::try_from(n).ok())
    }
    pub(crate) fn text(&self, key: &str) -> Option<&'a str> {
        if let Value::Text(text) = self.value(key)? { Some(text) } else { None }
    }
    fn list(&self, key: &str) -> Option<&'a [Item]> {
        if let Value::List(items) = self.value(key)? { Some(items) } else { None }
    }
    pub(crate) fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        self.list(key).map(numbers)
    }
    pub(crate) fn wholes(&self, key: &str) -> Option<Vec<usize>> {
        let whole = |item: &Item| usize::try_from(whole(&item.value)?).ok();
        self.list(key).map(|items| items.iter().filter_map(whole).collect())
    }
    pub(crate) fn texts(&self, key: &str) -> Vec<&'a str> {
        let text =
            |item: &'a Item| if let Value::Text(text) = &item.value { Some(text.as_str()) } else { None };
        self.list(key).unwrap_or_default().iter().filter_map(text).collect()
    }
    pub(crate) fn flags(&self, key: &str) -> Option<[bool; 3]> {
        let items = self.list(key)?;
        Some(std::array::from_fn(|a| {
            items.get(a).is_some_and(|item| matches!(item.value, Value::Flag(true)))
        }))
    }
    /// Lists of numbers within the list `key`.
    pub(crate) fn rows(&self, key: &str) -> Vec<Vec<f64>> {
        let row = |item: &Item| if let Value::List(items) = &item.value { numbers(items) } else { vec![] };
        self.list(key).unwrap_or_default().iter().map(row).collect()
    }
    /// Two or three numbers; the third is 0 in the plane.
    pub(crate) fn vector(&self, key: &str) -> Option<Vector> {
        let n = self.numbers(key)?;
        Some(Vector::new(n.first().copied()?, n.get(1).copied()?, n.get(2).copied().unwrap_or(0.0)))
    }
    /// The same of a scene of so many dimensions.
    pub(crate) fn vector_of(&self, key: &str, dim: usize) -> Result<Option<Vector>, Problem> {
        self.has_dim(key, dim)?;
        Ok(self.vector(key))
    }
    pub(crate) fn point_of(&self, key: &str, dim: usize) -> Result<Option<Point>, Problem> {
        Ok(self.vector_of(key, dim)?.map(Point::from))
    }
    /// A list whose length has to be that of the scene's vectors.
    pub(crate) fn has_dim(&self, key: &str, dim: usize) -> Result<(), Problem> {
        match self.list(key).map(<[Item]>::len) {
            Some(n) if n != dim => {
                let kind = if dim == 2 { "plane" } else { "space" };
                Err(self.fail(key, format!("{n} components in a scene in {kind}; give {dim}")))
            }
            _ => Ok(()),
        }
    }
    /// One formula per axis.
    pub(crate) fn formulas(
        &self,
        key: &str,
        variables: &[&str],
        dim: usize,
    ) -> Result<Option<[Expression; 3]>, Problem> {
        self.has_dim(key, dim)?;
        let Some(items) = self.list(key) else { return Ok(None) };
        let mut out = [const { None }; 3];
        for (slot, item) in out.iter_mut().zip(items) {
            *slot = Some(self.expression(key, item, variables)?);
        }
        Ok(Some(out.map(|e| e.unwrap_or(Expression::constant(0.0)))))
    }
    /// Whether item `i` of the list `key` is a formula that is not 0 everywhere.
    pub(crate) fn changes(&self, key: &str, i: usize) -> bool {
        let text = |item: &Item| if let Value::Text(text) = &item.value { Some(text.clone()) } else { None };
        let formula = self.list(key).and_then(|items| text(items.get(i)?));
        formula.is_some_and(|text| {
            let zero = Expression::new(&text, &["x", "y", "z", "t"]).map(|e| e.fixed());
            !matches!(zero, Ok(Some(0.0)) | Err(_))
        })
    }
    pub(crate) fn formula(&self, key: &str, variables: &[&str]) -> Result<Option<Expression>, Problem> {
        self.section.get(key).map(|item| self.expression(key, item, variables)).transpose()
    }
    fn expression(&self, key: &str, item: &Item, variables: &[&str]) -> Result<Expression, Problem> {
        match &item.value {
            Value::Text(text) => {
                let told = |e| {
                    Problem::new(
                        self.path_of(key),
                        item.place.clone(),
                        format!("the formula {} {e}", shown(text)),
                    )
                };
                let expression = Expression::new(text, variables).map_err(told)?;
                self.formulas.borrow_mut().push(Formula {
                    path: self.path_of(key),
                    place: item.place.clone(),
                    text: text.clone(),
                    variables: variables.iter().map(|v| (*v).to_owned()).collect(),
                    expression: expression.clone(),
                });
                Ok(expression)
            }
            value => Ok(Expression::constant(number(value).unwrap_or(0.0))),
        }
    }

    pub(crate) fn table(&self, key: &str) -> Option<Reader<'a>> {
        self.section.get(key).and_then(|item| self.inner(item, self.path_of(key)))
    }
    pub(crate) fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let items = self.list(key).unwrap_or_default();
        items
            .iter()
            .enumerate()
            .filter_map(|(i, item)| self.inner(item, format!("{}.{i}", self.path_of(key))))
            .collect()
    }
    /// The tables under names in `key`.
    pub(crate) fn named(&self, key: &str) -> Vec<(&'a str, Reader<'a>)> {
        let Some(Value::Table(section)) = self.value(key) else { return Vec::new() };
        let path = self.path_of(key);
        let entry = |(name, _, item): &'a (String, Place, Item)| {
            Some((name.as_str(), self.inner(item, format!("{path}.{name}"))?))
        };
        section.0.iter().filter_map(entry).collect()
    }
    /// The word that `tag` is in the table `key`, and that table; the word may stand there alone.
    pub(crate) fn choice(&self, key: &str, tag: &str) -> Option<(&'a str, Reader<'a>)> {
        self.section.get(key).and_then(|item| self.chosen(item, tag, self.path_of(key)))
    }
    pub(crate) fn choices(&self, key: &str, tag: &str) -> Vec<(&'a str, Reader<'a>)> {
        let items = self.list(key).unwrap_or_default();
        items
            .iter()
            .enumerate()
            .filter_map(|(i, item)| self.chosen(item, tag, format!("{}.{i}", self.path_of(key))))
            .collect()
    }
    fn inner(&self, item: &'a Item, path: String) -> Option<Self> {
        match &item.value {
            Value::Table(section) => Some(Self::new(section, item.place.clone(), path, self.formulas)),
            _ => None,
        }
    }
    fn chosen(&self, item: &'a Item, tag: &str, path: String) -> Option<(&'a str, Self)> {
        let table = |section| Self::new(section, item.place.clone(), path, self.formulas);
        match &item.value {
            Value::Text(word) => Some((word, table(&EMPTY))),
            Value::Table(section) => match &section.get(tag)?.value {
                Value::Text(word) => Some((word, table(section))),
                _ => None,
            },
            _ => None,
        }
    }
}

static EMPTY: Section = Section(Vec::new());

fn numbers(items: &[Item]) -> Vec<f64> {
    items.iter().filter_map(|item| number(&item.value)).collect()
}
