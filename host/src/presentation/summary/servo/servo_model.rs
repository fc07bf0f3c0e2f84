//! The servo as a machine, as text for a terminal.

use super::clauses::shows_load;
use super::kind_of_servo::shows_limit;
use super::quantity_table::quantities;
use super::servo_remarks::ServoRemarks;
use crate::data::model_file::ServoModelDocument;
use crate::data::units::Units;
use crate::presentation::summary::wording::layout::wrapped;
use crate::presentation::summary::wording::numbers::digits;
use crate::presentation::summary::wording::recorded;
use servoid_identification::results::with_unit;
use servoid_identification::servo_model::{
    LadderRung, LinearKind, LinearModelFit, LinearModels, LoadKind, Quantity, QuantityKind,
    ReachedSpeeds, ServoFit, ServoModel, Terms,
};

/// Parameters with their intervals; with `explain`, the terms that were tried.
#[must_use]
pub fn of_servo_model(document: &ServoModelDocument, units: Units<'_>, explain: bool) -> String {
    let model = &document.model;
    let level = model.covariance.as_ref().map(|covariance| covariance.level);
    let mut text = format!(
        "\nservo model: {}\n  fit {:.2} %; of parts that it had not seen {:.2} % (a linear servo of second order: {:.2} %)\n  {}\n{}",
        kind_in_words(model),
        model.fit.simulation_percent,
        model.fit.held_out_percent,
        model.fit.linear_held_out_percent,
        error_in_words(model, units),
        tested_in(model, units)
    );
    let remarks = ServoRemarks::of(document, units);
    let line = |remark: &String| format!("  {}\n", wrapped(remark, 2));
    text.extend(remarks.before.iter().map(line));
    let may_be_extrapolated = |quantity: &Quantity| model.stayed_below(quantity);
    text += &quantities(&model.quantities, level, units, may_be_extrapolated);
    text.extend(remarks.behind.iter().map(line));
    if explain {
        text +=
            "\n  terms that were tried: fit of parts that they had not seen, and of the whole\n";
        text.extend(model.ladder.iter().map(rung));
        text.extend(
            model
                .linear_models
                .as_ref()
                .map(|found| linear_models(found, &model.fit)),
        );
    }
    text
}

/// "error 0.0622 deg rms": noise and what the model lacks.
pub(crate) fn error_in_words(model: &ServoModel, units: Units<'_>) -> String {
    let error = digits(model.fit.rmse, 3);
    format!(
        "error {} rms",
        with_unit(error, units.output.unwrap_or_default())
    )
}

/// What the recording had, which is all that the fit says something of: a line.
fn tested_in(model: &ServoModel, units: Units<'_>) -> String {
    let Some((commands, reached)) = model.commands.zip(model.reached) else {
        return String::new();
    };
    let unit = units.output.unwrap_or("units");
    let speeds = recorded::speeds_in_words(reached, 1.0, unit);
    let speeds = speeds.map_or_else(String::new, |speeds| {
        format!(
            ", and speeds of {speeds} at the least{}",
            elsewhere(model, reached)
        )
    });
    let words = format!(
        "in commands {}{speeds}: beyond these the model was not tested",
        recorded::range_in_words(commands, units)
    );
    format!("  {}\n", wrapped(&words, 2))
}

/// Why a servo under a load may be faster than its top speed.
fn elsewhere(model: &ServoModel, reached: ReachedSpeeds) -> &'static str {
    let is_faster =
        |kind, reached: f64| model.quantity(kind).is_some_and(|top| top.value < reached);
    match is_faster(QuantityKind::TopSpeedUpwards, reached.upwards)
        || is_faster(QuantityKind::TopSpeedDownwards, reached.downwards)
    {
        true if model.parameters(0).load.changes_with_angle() => {
            " (the top speed is that at the middle of the commands; elsewhere the load helps)"
        }
        _ => "",
    }
}

/// The table of the linear models beside the servo model.
fn linear_models(found: &LinearModels, fit: &ServoFit) -> String {
    let samples = match found.samples_used == fit.samples_used {
        true => "all samples".to_owned(),
        false => format!(
            "the {} of {} samples that all predict",
            found.samples_used, fit.samples_used
        ),
    };
    let mut text = format!(
        "\n  linear models beside it, each identified again without the parts that it predicts: fit on {samples}\n"
    );
    let row = |percent: f64, name: &str| format!("  {percent:7.2} %  {name}\n");
    text += &row(found.servo_model_percent, "this servo model");
    let name = |kind: LinearKind| match kind {
        LinearKind::Linear => "linear model",
        LinearKind::DirectionSplit => "linear model of strokes up, and of strokes down",
    };
    let of = |model: &LinearModelFit| row(model.held_out_percent, name(model.kind));
    text.extend(found.models.iter().map(of));
    text
}

fn rung(tried: &LadderRung) -> String {
    format!(
        "  {:7.2} % {:7.2} %  {}{}\n",
        tried.held_out_percent,
        tried.fit_percent,
        terms_in_words(tried.terms),
        if tried.chosen { "  <- chosen" } else { "" }
    )
}

const LIMIT_LEFT_OPEN: &str = "a limit of the drive that the recording leaves open";

/// The terms of a model, as [`terms_in_words`]. Apart from these stand the limit of the drive, with which friction and a dead band come, where the recording leaves it
/// open, and a load that no interval shows.
pub(crate) fn kind_in_words(model: &ServoModel) -> String {
    let terms = model.terms;
    let limit_is_open = terms.limit && !shows_limit(model);
    let load_is_open = terms.load != LoadKind::None && !shows_load(model);
    let sure = Terms {
        limit: terms.limit && !limit_is_open,
        two_speeds: terms.two_speeds && (terms.speed_limit || !limit_is_open),
        load: if load_is_open {
            LoadKind::None
        } else {
            terms.load
        },
        ..terms
    };
    let open = [
        limit_is_open.then(|| LIMIT_LEFT_OPEN.to_owned()),
        load_is_open.then(|| format!("a {} that no interval shows", load_in_words(terms.load))),
    ];
    let open: Vec<String> = open.into_iter().flatten().collect();
    match (sure == Terms::default(), open.is_empty()) {
        (_, true) => terms_in_words(sure),
        (true, _) => open.join(", and "),
        (false, _) => format!("{} (and {})", terms_in_words(sure), open.join(", and ")),
    }
}

fn load_in_words(load: LoadKind) -> &'static str {
    match load {
        LoadKind::None => "",
        LoadKind::Constant => "constant load",
        LoadKind::Pendulum => "load as of a weight on a hanging arm",
        LoadKind::Spring => "load as of a spring",
        LoadKind::TiltedPendulum => "load as of a weight on a tilted arm",
        LoadKind::Air => "load of the air",
    }
}

/// "limit of the drive, friction, load as of a weight on a hanging arm"
pub(crate) fn terms_in_words(terms: Terms) -> String {
    let all = [
        (terms.limit, "limit of the drive"),
        (terms.speed_limit, "limit of the speed"),
        (terms.two_speeds, "two speeds"),
        (terms.dead_band, "dead band"),
        (terms.play, "play"),
        (terms.friction && !terms.friction_of_gears, "friction"),
        (terms.friction_of_gears, "friction of loaded gears"),
        (terms.load != LoadKind::None, load_in_words(terms.load)),
    ];
    let present: Vec<&str> = all
        .into_iter()
        .filter_map(|(there, word)| there.then_some(word))
        .collect();
    match present.is_empty() {
        true => "linear, of second order".to_owned(),
        false => present.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::servo::limited_servo::limited_servo;
    use servoid_identification::results::{Bounds, Reason};

    #[test]
    fn a_limit_that_the_recording_leaves_open_is_no_kind_of_servo() {
        let mut model = limited_servo();
        model.terms = Terms {
            limit: true,
            ..Terms::default()
        };
        let mut kind = |is_shown: bool, friction: bool| {
            model.terms.friction = friction;
            for quantity in &mut model.quantities {
                let of_limit = quantity
                    .kind()
                    .is_some_and(|kind| QuantityKind::OF_LIMIT.contains(&kind));
                quantity.determined = is_shown || !of_limit;
            }
            kind_in_words(&model)
        };
        assert_eq!(kind(true, true), "limit of the drive, friction");
        assert_eq!(
            kind(false, true),
            "friction (and a limit of the drive that the recording leaves open)"
        );
        assert_eq!(kind(false, false), LIMIT_LEFT_OPEN);
    }

    #[test]
    fn a_load_without_an_interval_is_no_kind_of_servo() {
        let mut model = limited_servo();
        model.terms = Terms {
            friction: true,
            load: LoadKind::Constant,
            ..Terms::default()
        };
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        let kind = kind_in_words(&model);
        assert_eq!(
            kind,
            "friction (and a constant load that no interval shows)"
        );
    }
}
