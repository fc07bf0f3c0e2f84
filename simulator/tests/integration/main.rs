//! Simulated servos and rigs from outside: their equations, their figures, and the rig's conversation.

mod equations;
mod figures;
mod in_process;
