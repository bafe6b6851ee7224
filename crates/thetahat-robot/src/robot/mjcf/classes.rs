//! Attributes that elements have from the classes of `<default>`.

use std::collections::HashMap;

use super::{
    element::{Attribute, Element},
    error::MjcfError,
};

/// The class of elements that name none, around all others.
pub(super) const MAIN: &str = "main";
/// Most classes, and how deep they are nested.
const MOST_CLASSES: usize = 5000;
const DEEPEST: usize = 50;
/// Most elements of one class: there are thirty kinds.
const MOST_ELEMENTS: usize = 100;

/// The classes of a model.
pub(super) struct Classes<'a> {
    classes: HashMap<&'a str, Class<'a>>,
}

struct Class<'a> {
    /// The class around it.
    outer: Option<&'a str>,
    depth: usize,
    /// Its `<default>`; several for the outermost class.
    defaults: Vec<Element<'a>>,
}

/// An element with those of its classes, from which it has the attributes that it does not state.
pub(super) struct Properties<'a> {
    /// The element first, then the elements of its class and of the classes around it.
    levels: Vec<Element<'a>>,
}

impl<'a> Classes<'a> {
    pub(super) fn read(root: Element<'a>) -> Result<Self, MjcfError> {
        let main = Class { outer: None, depth: 0, defaults: root.named("default").collect() };
        main.defaults.iter().try_for_each(|default| check_size(*default))?;
        let mut waiting: Vec<(Element<'a>, &'a str, usize)> = nested(&main.defaults, MAIN, 1);
        let renamed: Vec<&str> = main.defaults.iter().filter_map(|default| default.text_of("class")).collect();
        let mut classes = HashMap::from([(MAIN, main)]);
        // The outermost class may have another name in models for older versions of MuJoCo.
        for name in renamed.into_iter().filter(|name| *name != MAIN) {
            classes.insert(name, Class { outer: Some(MAIN), depth: 1, defaults: Vec::new() });
        }
        while let Some((default, outer, depth)) = waiting.pop() {
            let name = default.required("class", "give every nested <default> a class")?.text;
            if classes.len() >= MOST_CLASSES || depth > DEEPEST {
                let (what, limit) =
                    if depth > DEEPEST { ("nested classes", DEEPEST) } else { ("classes", MOST_CLASSES) };
                return Err(MjcfError::TooLarge { path: default.path().to_owned(), what, limit });
            }
            check_size(default)?;
            waiting.extend(nested(&[default], name, depth + 1));
            let class = Class { outer: Some(outer), depth, defaults: vec![default] };
            if let Some(first) = classes.insert(name, class).and_then(|first| first.defaults.first().copied()) {
                return Err(default.same_name(first));
            }
        }
        Ok(Self { classes })
    }

    /// The class that an element states by `key`, if it states one.
    pub(super) fn stated(&self, element: Element<'a>, key: &'static str) -> Result<Option<&'a str>, MjcfError> {
        let Some(class) = element.text_of(key) else { return Ok(None) };
        if self.classes.contains_key(class) { Ok(Some(class)) } else { Err(element.unknown("class", class)) }
    }

    /// An element with the attributes that its class gives to elements of these `tags`; `class` is that of the bodies around it.
    pub(super) fn of(&self, element: Element<'a>, class: &'a str, tags: &[&str]) -> Result<Properties<'a>, MjcfError> {
        let mut levels = vec![element];
        let mut next = Some(self.stated(element, "class")?.unwrap_or(class));
        while let Some(class) = next.and_then(|name| self.classes.get(name)) {
            let elements = class.defaults.iter().rev().flat_map(|default| default.elements().rev());
            levels.extend(elements.filter(|element| tags.contains(&element.tag())));
            next = class.outer.filter(|_| class.depth > 0);
        }
        Ok(Properties { levels })
    }
}

/// An attribute is searched in all elements of a class.
fn check_size(default: Element<'_>) -> Result<(), MjcfError> {
    let count = default.elements().filter(|element| element.tag() != "default").count();
    let (path, what) = (default.path().to_owned(), "elements in one class");
    if count > MOST_ELEMENTS { Err(MjcfError::TooLarge { path, what, limit: MOST_ELEMENTS }) } else { Ok(()) }
}

fn nested<'a>(defaults: &[Element<'a>], outer: &'a str, depth: usize) -> Vec<(Element<'a>, &'a str, usize)> {
    let nested = defaults.iter().flat_map(|default| default.named("default"));
    nested.map(|default| (default, outer, depth)).collect()
}

impl<'a> Properties<'a> {
    /// An element without a class.
    pub(super) fn own(element: Element<'a>) -> Self {
        Self { levels: vec![element] }
    }

    pub(super) fn element(&self) -> Element<'a> {
        self.levels[0]
    }

    /// The element itself, then those of its classes.
    pub(super) fn levels(&self) -> &[Element<'a>] {
        &self.levels
    }

    pub(super) fn attribute(&self, key: &'static str) -> Option<Attribute<'a>> {
        self.levels.iter().find_map(|level| level.attribute(key))
    }

    pub(super) fn text_of(&self, key: &'static str) -> Option<&'a str> {
        self.attribute(key).map(|attribute| attribute.text)
    }

    pub(super) fn number(&self, key: &'static str) -> Result<Option<f64>, MjcfError> {
        self.attribute(key).map(Attribute::number).transpose()
    }

    pub(super) fn numbers<const N: usize>(&self, key: &'static str) -> Result<Option<[f64; N]>, MjcfError> {
        self.attribute(key).map(Attribute::numbers).transpose()
    }

    /// Numbers of which an element may state the first ones only: the others are those of its class, and otherwise `default`.
    pub(super) fn leading<const N: usize>(&self, key: &'static str, default: [f64; N]) -> Result<[f64; N], MjcfError> {
        let mut values = default;
        for attribute in self.levels.iter().rev().filter_map(|level| level.attribute(key)) {
            attribute.overlay(&mut values)?;
        }
        Ok(values)
    }

    pub(super) fn is(&self, key: &'static str) -> Result<bool, MjcfError> {
        Ok(self.attribute(key).map(Attribute::flag).transpose()?.flatten().unwrap_or(false))
    }
}
