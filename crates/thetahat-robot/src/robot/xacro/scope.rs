//! Properties, blocks and macros by scope. A macro's scope is inside that of its caller; a namespace holds those of an
//! included file.

use std::{collections::HashMap, rc::Rc};

use super::{macros::Macro, tree::Element, value::Value};

/// The scope of the whole file.
pub(super) const GLOBAL: usize = 0;

/// The state of a property.
#[derive(Debug, Clone)]
pub(super) enum Property {
    /// Its value.
    Known(Value),
    /// A text that is evaluated when the property is first used.
    Text(Rc<str>),
    /// Its text is being evaluated.
    InEvaluation,
}

/// Elements to insert.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) element: Rc<Element>,
    /// Whether the element itself is inserted, otherwise what it contains.
    pub(super) whole: bool,
}

#[derive(Debug, Default)]
struct Scope {
    /// The scope in which other names are looked up.
    parent: Option<usize>,
    /// The scope in which other macros are looked up.
    parent_of_macros: Option<usize>,
    is_namespace: bool,
    properties: HashMap<String, Property>,
    blocks: HashMap<String, Block>,
    macros: HashMap<String, Rc<Macro>>,
    namespaces: HashMap<String, usize>,
}

/// All scopes; inner ones come after outer ones.
#[derive(Debug)]
pub(super) struct Scopes(Vec<Scope>);

impl Scopes {
    pub(super) fn new() -> Self {
        Self(vec![Scope::default()])
    }

    /// A scope inside another, in which a macro is expanded; the caller's number of scopes is restored by
    /// [`Scopes::leave`].
    pub(super) fn enter(&mut self, parent: usize) -> usize {
        self.0.push(Scope { parent: Some(parent), parent_of_macros: Some(parent), ..Scope::default() });
        self.0.len() - 1
    }

    /// Forgets the scope and all that were made inside it.
    pub(super) fn leave(&mut self, scope: usize) {
        self.0.truncate(scope.max(1));
    }

    /// A namespace for an included file.
    pub(super) fn add_namespace(&mut self, parent: usize, name: &str) -> usize {
        self.0.push(Scope { parent: Some(parent), is_namespace: true, ..Scope::default() });
        let added = self.0.len() - 1;
        if let Some(scope) = self.0.get_mut(parent) {
            scope.namespaces.insert(name.to_owned(), added);
        }
        added
    }

    fn outward(&self, from: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(from), |scope| self.0.get(*scope).and_then(|scope| scope.parent))
    }

    /// The scope that has the property of this name.
    pub(super) fn owner(&self, from: usize, name: &str) -> Option<usize> {
        self.outward(from).find(|scope| self.0[*scope].properties.contains_key(name))
    }

    /// The property of exactly this scope.
    pub(super) fn property(&self, scope: usize, name: &str) -> Option<&Property> {
        self.0.get(scope)?.properties.get(name)
    }

    pub(super) fn set(&mut self, scope: usize, name: &str, property: Property) {
        if let Some(scope) = self.0.get_mut(scope) {
            scope.properties.insert(name.to_owned(), property);
        }
    }

    /// Removes a property from this scope and all outside it.
    pub(super) fn remove(&mut self, from: usize, name: &str) {
        let all: Vec<usize> = self.outward(from).collect();
        all.into_iter().for_each(|scope| _ = self.0[scope].properties.remove(name));
    }

    pub(super) fn block(&self, from: usize, name: &str) -> Option<&Block> {
        self.outward(from).find_map(|scope| self.0[scope].blocks.get(name))
    }

    pub(super) fn set_block(&mut self, scope: usize, name: &str, block: Block) {
        if let Some(scope) = self.0.get_mut(scope) {
            scope.blocks.insert(name.to_owned(), block);
        }
    }

    pub(super) fn namespace(&self, from: usize, name: &str) -> Option<usize> {
        self.outward(from).find_map(|scope| self.0[scope].namespaces.get(name).copied())
    }

    pub(super) fn add_macro(&mut self, scope: usize, added: Macro) {
        if let Some(scope) = self.0.get_mut(scope) {
            scope.macros.insert(added.name.clone(), Rc::new(added));
        }
    }

    /// The macro of a name such as `arm` or `left.arm`, and the scope in which its scope is.
    pub(super) fn find_macro(&self, from: usize, name: &str) -> Option<(Rc<Macro>, usize)> {
        let (scope, own) = match name.rsplit_once('.') {
            None => (from, name),
            Some((path, own)) => {
                let namespace = path.split('.').try_fold(from, |scope, part| self.namespace(scope, part));
                (namespace?, own)
            }
        };
        let mut outward =
            std::iter::successors(Some(scope), |scope| self.0.get(*scope).and_then(|scope| scope.parent_of_macros));
        outward.find_map(|scope| self.0[scope].macros.get(own).cloned()).map(|found| (found, scope))
    }

    /// The scope outside of a macro, that of its caller.
    pub(super) fn caller(&self, scope: usize) -> Option<usize> {
        if self.0[scope].is_namespace {
            return self.0[scope].parent;
        }
        self.outward(scope).skip(1).find(|scope| !self.0[*scope].is_namespace)
    }
}
