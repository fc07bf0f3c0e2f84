//! A JSBSim system: hold, delay and poles.

use super::described_model::Export;
use super::error::ExportError;
use super::statement::low_order_covariance;
use super::text::{Style, identifier, number};
use crate::presentation::template::fill;
use servoid_identification::flight_model::LowOrder;

const STYLE: Style = Style {
    comment: "  ",
    // Two hyphens end a comment of XML, and one must not be its last sign.
    forbidden: &[("--", "- -")],
    between: ", ",
    broken: "",
    row: ("[", "]"),
};

/// The system.
pub(super) fn write(export: &Export<'_>) -> Result<String, ExportError> {
    let flight = match &export.low_order {
        Ok(flight) => flight,
        Err(reason) => return Err(ExportError::NoLowOrder(reason.clone())),
    };
    let id = identifier(export.name);
    let held = export.frame_s() > 0.0;
    let mut paragraphs = export.statement(held);
    paragraphs.extend(low_order_covariance(flight, &STYLE));
    paragraphs.push(
        "Run it at 500 Hz or more: JSBSim replaces poles by Tustin's rule and has delays of whole steps, so that the position is right to half a step of time. Set the step before the aircraft is loaded: delays are counted out then."
            .to_owned(),
    );
    let (filters, output) = filters(&flight.transfer, &id);
    let input = if held { "held" } else { "cmd" };
    let hold = if held {
        hold(&id, export.frame_s())
    } else {
        String::new()
    };
    let values = [
        ("about", STYLE.comment(&paragraphs)),
        ("hold", hold),
        ("input", format!("fcs/{id}-{input}")),
        ("delay", number(flight.transfer.delay_s.max(0.0))),
        ("filters", filters),
        ("output", output),
        ("gain", number(flight.transfer.gain)),
        ("id", id),
    ];
    Ok(fill(include_str!("templates/servo.xml"), &values))
}

/// A switch that lets a new command through at the first step of each frame only.
fn hold(id: &str, frame_s: f64) -> String {
    format!(
        r#"    <!-- Time within the pulse frame, half a step late so that rounding moves no frame. -->
    <fcs_function name="fcs/{id}-frame-time">
      <function>
        <product>
          <value>{frame}</value>
          <fraction>
            <quotient>
              <sum>
                <property>simulation/sim-time-sec</property>
                <product><value>0.5</value><property>simulation/dt</property></product>
              </sum>
              <value>{frame}</value>
            </quotient>
          </fraction>
        </product>
      </function>
    </fcs_function>
    <!-- The command as the servo has it: new at the beginning of a frame, held for the rest. -->
    <switch name="fcs/{id}-held">
      <default value="fcs/{id}-held"/>
      <test logic="AND" value="fcs/{id}-cmd">
        fcs/{id}-frame-time lt simulation/dt
      </test>
    </switch>"#,
        frame = number(frame_s)
    )
}

/// The poles, one component for each factor of the denominator, and the property that they end in.
fn filters(transfer: &LowOrder, id: &str) -> (String, String) {
    let mut parts = Vec::new();
    let mut last = format!("fcs/{id}-aligned");
    if let Some(lag) = transfer.lag_s {
        let name = format!("fcs/{id}-lagged");
        parts.push(format!(
            "    <lag_filter name=\"{name}\">\n      <input>{last}</input>\n      <c1>{}</c1>\n    </lag_filter>",
            number(1.0 / lag)
        ));
        last = name;
    }
    if let Some(oscillator) = transfer.oscillator {
        let name = format!("fcs/{id}-moved");
        let w = oscillator.omega_rad_s;
        parts.push(format!(
            "    <second_order_filter name=\"{name}\">\n      <input>{last}</input>\n      <c1>0</c1><c2>0</c2><c3>{square}</c3>\n      <c4>1</c4><c5>{middle}</c5><c6>{square}</c6>\n    </second_order_filter>",
            square = number(w * w),
            middle = number(2.0 * oscillator.damping * w)
        ));
        last = name;
    }
    (parts.join("\n"), last)
}
