//! Expressions with arithmetic operators: handles of nodes in a [`Builder`].

use std::{
    cell::RefCell,
    ops::{Add, Div, Mul, Neg, Sub},
};

use super::{
    derivative::derivatives,
    graph::{Array, Graph, Signed},
};
use thetahat_model::robot::MathFunction;

/// Creates expressions.
#[derive(Debug, Default)]
pub(super) struct Builder {
    graph: RefCell<Graph>,
}

/// An expression of a [`Builder`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Expression<'g> {
    builder: &'g Builder,
    pub(super) value: Signed,
}

/// Three expressions: a vector.
pub(super) type Vector<'g> = [Expression<'g>; 3];
/// Three rows.
pub(super) type Matrix<'g> = [Vector<'g>; 3];

impl Builder {
    pub(super) fn constant(&self, value: f64) -> Expression<'_> {
        self.expression(self.graph.borrow_mut().constant(value))
    }

    pub(super) fn zero(&self) -> Expression<'_> {
        self.constant(0.0)
    }

    pub(super) fn constants(&self, values: [f64; 3]) -> Vector<'_> {
        values.map(|value| self.constant(value))
    }

    pub(super) fn input(&self, array: Array, index: usize) -> Expression<'_> {
        self.expression(self.graph.borrow_mut().input(array, index))
    }

    /// An input of each of the coordinates.
    pub(super) fn inputs(&self, array: Array, count: usize) -> Vec<Expression<'_>> {
        (0..count).map(|index| self.input(array, index)).collect()
    }

    pub(super) fn into_graph(self) -> Graph {
        self.graph.into_inner()
    }

    fn expression(&self, value: Signed) -> Expression<'_> {
        Expression { builder: self, value }
    }
}

impl<'g> Expression<'g> {
    /// Its value, if it is a constant.
    pub(super) fn number(self) -> Option<f64> {
        self.builder.graph.borrow().value(self.value)
    }

    pub(super) fn is_zero(self) -> bool {
        self.number() == Some(0.0)
    }

    pub(super) fn builder(self) -> &'g Builder {
        self.builder
    }

    pub(super) fn sine(self) -> Self {
        self.map(Graph::sine)
    }

    pub(super) fn cosine(self) -> Self {
        self.map(Graph::cosine)
    }

    pub(super) fn sign(self) -> Self {
        self.map(Graph::sign)
    }

    /// The magnitude.
    pub(super) fn magnitude(self) -> Self {
        self.function_with(MathFunction::Larger, -self)
    }

    /// A function of one argument.
    pub(super) fn function(self, function: MathFunction) -> Self {
        self.map(|graph, a| graph.function(function, a, None))
    }

    /// A function of two arguments.
    pub(super) fn function_with(self, function: MathFunction, other: Self) -> Self {
        self.with(other, |graph, a, b| graph.function(function, a, Some(b)))
    }

    /// The derivatives of expressions with respect to an input; the sign of a velocity is treated as constant.
    pub(super) fn derivatives(of: &[Self], array: Array, index: usize) -> Vec<Self> {
        let Some(builder) = of.first().map(|first| first.builder) else { return Vec::new() };
        let mut graph = builder.graph.borrow_mut();
        let values: Vec<Signed> = of.iter().map(|expression| expression.value).collect();
        derivatives(&mut graph, &values, array, index).into_iter().map(|value| builder.expression(value)).collect()
    }

    fn map(self, f: impl Fn(&mut Graph, Signed) -> Signed) -> Self {
        self.builder.expression(f(&mut self.builder.graph.borrow_mut(), self.value))
    }

    fn with(self, other: Self, f: impl Fn(&mut Graph, Signed, Signed) -> Signed) -> Self {
        self.builder.expression(f(&mut self.builder.graph.borrow_mut(), self.value, other.value))
    }
}

impl Add for Expression<'_> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, Graph::add)
    }
}

impl Sub for Expression<'_> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Expression<'_> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.with(other, Graph::multiply)
    }
}

impl Mul<f64> for Expression<'_> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self * self.builder.constant(factor)
    }
}

impl Div for Expression<'_> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.with(other, Graph::divide)
    }
}

impl Neg for Expression<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: self.value.times_sign(true), ..self }
    }
}

pub(super) fn add<'g>(a: Vector<'g>, b: Vector<'g>) -> Vector<'g> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn cross<'g>(a: Vector<'g>, b: Vector<'g>) -> Vector<'g> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn dot<'g>(a: Vector<'g>, b: Vector<'g>) -> Expression<'g> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `A x`.
pub(super) fn times<'g>(a: &Matrix<'g>, x: Vector<'g>) -> Vector<'g> {
    a.map(|row| dot(row, x))
}
