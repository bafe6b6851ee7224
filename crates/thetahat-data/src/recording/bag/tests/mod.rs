//! Tests of bags: written by the tests themselves (`written`), and by other programs (`bags`).

mod bags;
mod damage;
mod definitions;
mod folders;
mod joint_states;
mod messages;
mod publishers;
mod written;
