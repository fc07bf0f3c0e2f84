use super::*;

fn table(text: &str) -> Result<Table, TableFault> {
    Table::parse(text.as_bytes().to_vec())
}

#[test]
fn columns_are_found_by_name_and_empty_cells_are_missing_samples() {
    let table = table("# remark\n t , u,y\n0,1,2\n# another\n1,,4e-1\n").unwrap();
    let columns = table.numbers(&["y", "u"]).unwrap();
    assert_eq!(columns[0], [2.0, 0.4]);
    assert!(columns[1][0] == 1.0 && columns[1][1].is_nan());
}

#[test]
fn spaces_around_cells_and_line_ends_of_windows_do_not_matter() {
    let table = table("u, y\r\n 1 ,\t2\r\n  , 3 \r\n").unwrap();
    let columns = table.numbers(&["u", "y"]).unwrap();
    assert_eq!(columns[1], [2.0, 3.0]);
    assert!(columns[0][0] == 1.0 && columns[0][1].is_nan());
}

#[test]
fn each_mistake_is_one_sentence_that_names_the_place() {
    let errors = [
        table("").unwrap_err(),
        table("u,y\n1,up\n")
            .unwrap()
            .numbers(&["u", "y"])
            .unwrap_err(),
        table("u,y\n1,2\n1,inf\n")
            .unwrap()
            .numbers(&["y"])
            .unwrap_err(),
        table("u,y\n1,2\n").unwrap().numbers(&["z"]).unwrap_err(),
        table("u,y\n1,2\n1\n").unwrap().numbers(&["u"]).unwrap_err(),
    ];
    for (error, words) in errors.iter().zip([
        "empty",
        "line 2, column \"y\": \"up\"",
        "line 3",
        "columns are u, y",
        "line 3 has 1 cells",
    ]) {
        let text = error.to_string();
        assert!(text.contains(words) && !text.contains('\n'), "{text}");
    }
}

fn read(text: &str, names: &[&str]) -> Vec<Vec<f64>> {
    table(text).unwrap().numbers(names).unwrap()
}

#[test]
fn semicolons_tabs_and_decimal_commas_are_seen_by_what_makes_numbers() {
    let expected = [vec![0.0, 0.5], vec![1.25, -2.5]];
    for text in [
        "t,u\n0,1.25\n0.5,-2.5\n",
        "t;u\n0;1.25\n0.5;-2.5\n",
        "t;u\n0;1,25\n0,5;-2,5\n",
        "t\tu\n0\t1,25\n0,5\t-2,5\n",
        "t\tu\r\n0\t1.25\r\n0.5\t-2.5\r\n",
        "\u{feff}t,u\n0,1.25\n0.5,-2.5\n",
        "sep=;\nt;u\n0;1,25\n0,5;-2,5\n",
        "\"t\",\"u\"\n\"0\",\"1.25\"\n\"0.5\",\"-2.5\"\n",
        "t,u,\n0,1.25,\n0.5,-2.5,\n",
        "t,u\n0,1.25,\n0.5,-2.5,\n",
    ] {
        assert_eq!(read(text, &["t", "u"]), expected, "{text}");
    }
}

#[test]
fn text_above_the_header_row_units_below_it_and_no_header_row_at_all() {
    let above = "Logger 3000\nDate,2024-05-01\nRate,500\n\nTime,Angle\n[ms],[deg]\n0,1\n2,3\n4,5\n";
    let found = table(above).unwrap();
    assert_eq!(found.columns(), ["Time [ms]", "Angle [deg]"]);
    assert_eq!(found.numbers(&["angle"]).unwrap(), [[1.0, 3.0, 5.0]]);
    assert!(
        found.remarks()[0].contains("3 lines above"),
        "{:?}",
        found.remarks()
    );
    let error = table(&(above.to_owned() + "6,up\n"))
        .unwrap()
        .numbers(&["Angle"]);
    assert!(error.unwrap_err().to_string().contains("line 10"));

    let commas = table("t;\"set, deg\"\n0;1\n1;2\n").unwrap();
    assert_eq!(commas.columns_clause(), "its columns are t, \"set, deg\"");
    let bare = table("0,1,2\n0.1,3,4\n").unwrap();
    assert_eq!(bare.numbers(&["1", "3"]).unwrap(), [[0.0, 0.1], [2.0, 4.0]]);
    assert!(bare.remarks()[0].contains("no header row"));
    assert!(bare.columns_clause().ends_with("called 1 to 3"));
}

#[test]
fn a_column_is_found_by_its_name_without_the_unit_where_one_is_meant() {
    let text = "t_ms,u_deg,y deg,y_raw\n0,1,2,9\n1,3,4,9\n";
    assert_eq!(read(text, &["u", "Y"]), [[1.0, 3.0], [2.0, 4.0]]);
    // The plain name is one column's whole name.
    assert_eq!(read("u,u_deg\n1,2\n3,4\n", &["U"]), [[1.0, 3.0]]);
    let two = table("u_deg,u_us\n1,2\n3,4\n").unwrap();
    let error = two.numbers(&["u"]).unwrap_err().to_string();
    assert!(error.contains("several columns"), "{error}");
    let german = table("t,Sollwert in Grad,Ist in Grad\n0,1,2\n").unwrap();
    let error = german.numbers(&["Sollwert"]).unwrap_err().to_string();
    assert!(
        error.ends_with("; perhaps \"Sollwert in Grad\" is meant"),
        "{error}"
    );
}

#[test]
fn times_of_a_clock_are_counted_in_seconds() {
    let times = |text: &str| {
        let table = table(text).unwrap();
        table.numbers_beside(&["u"], Some("t")).unwrap().1
    };
    let found = times("t,u\n14:00:01.230,1\n,2\n14:00:01.250,3\n").unwrap();
    assert!(found.of_clock);
    assert!((found.numbers[2] - 0.02).abs() < 1e-9 && found.numbers[1].is_nan());
    assert!(!times("t,u\n0.1,1\n0.2,2\n").unwrap().of_clock);
    for mixed in ["t,u\n0.1,1\n14:00:01,2\n", "t,u\n14:00:01,1\n0.2,2\n"] {
        assert!(times(mixed).is_none(), "{mixed}");
    }
}

#[test]
fn what_is_not_certain_is_asked_and_not_guessed() {
    let refused = |text: &str, names: &[&str]| match table(text) {
        Err(error) => error.to_string(),
        Ok(table) => table.numbers(names).unwrap_err().to_string(),
    };
    for (text, words) in [
        ("t;u\n0;1,5\n1;1.234\n", "decimal comma (line 2)"),
        ("t,u\n0,0,1,5\n0,1,2,5\n", "semicolons or tabs"),
        ("u,u\n1,2\n3,4\n", "several columns"),
        ("U [deg],u [V]\n1,2\n3,4\n", "several columns"),
        ("t u y\n0 1 2\n1 2 3\n", "parted by spaces"),
        ("PK\u{3}\u{4}....", "save the sheet as CSV"),
    ] {
        let said = refused(
            text,
            &["t", "u"][usize::from(text.to_lowercase().starts_with('u'))..],
        );
        assert!(said.contains(words) && !said.contains('\n'), "{said}");
    }
}

#[test]
fn a_cell_that_is_no_number_has_the_remedy_for_what_it_is() {
    let said = |text: &str| {
        let table = Table::parse(text.as_bytes().to_vec()).unwrap();
        table.numbers(&["u"]).unwrap_err().to_string()
    };
    for (text, remedy) in [
        (
            "t,u\n0,1\n1,2\nt,u\n2,3\n",
            "this is the header row once more",
        ),
        (
            "t,u\n\"0,1\",\"0,2\"\n\"0,3\",\"0,4\"\n",
            "where that is a decimal comma, write points",
        ),
        (
            "t;u\n0;1,5 deg\n1;2,5 deg\n",
            "write the unit in the header row",
        ),
        ("t,u\n0,1\n1,2\n2,off\n", "leave the cell empty"),
    ] {
        assert!(said(text).contains(remedy), "{}", said(text));
    }
}

#[test]
fn vertical_bars_part_cells_and_a_first_column_of_times_is_known() {
    let table = Table::parse(b"t|u|y\n0|1|2\n1|3|4\n".to_vec()).unwrap();
    assert_eq!(table.columns(), ["t", "u", "y"]);
    assert_eq!(table.numbers(&["y"]).unwrap(), [[2.0, 4.0]]);
    assert!(!table.begins_with_times());
    let of = |text: &str| {
        Table::parse(text.as_bytes().to_vec())
            .unwrap()
            .begins_with_times()
    };
    assert!(of("0.00,1,2\n0.02,3,4\n0.04,5,6\n"));
    assert!(!of("0.00,1,2\n0.02,3,4\n0.01,5,6\n"));
}
