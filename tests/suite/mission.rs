//! Missions: the decision layer, against an independent implementation and closed forms.

mod allocation;
mod behaviour;
mod draws;
mod flight;
mod golden_missions;
mod invariants;
mod map_files;
mod pages;
mod planner;
mod refusals;
mod rules;
mod scenarios;
mod travel_time;
mod vision;
mod world;
