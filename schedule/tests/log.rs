//! Event logs: a row for each element of each task.

mod support;

use support::*;
use topout_schedule::{Activity, ReadOptions};

fn values<'a>(activity: &'a Activity, name: &str) -> Option<Vec<&'a str>> {
    let field = activity.element_fields.iter().find(|f| *f.name == *name)?;
    Some(field.values.iter().map(|v| &**v).collect())
}

#[test]
fn rows_of_a_task_are_one_activity() {
    let schedule = csv("GUID,IfcClass,TaskID,TaskName,TaskStart,TaskFinish,Crew,Element on time\n\
         W1,IfcWall,T1,Walls,26-2-2015,27-2-2015,A,On time\n\
         S1,IfcSlab,T2,Slab,2-3-2015,2-3-2015,B,Too late\n\
         W2,IfcWall,T1,Walls,26-2-2015,27-2-2015,A,Too late\n\
         D1,IfcDoor,T1,Walls,26-2-2015,27-2-2015,A,\n");
    assert_eq!(findings(&schedule), [("event-log", 1), ("guessed-dates", 1)]);
    assert_says(message(&schedule, "event-log"), &["4 rows of 2 tasks", "GUID", "TaskStart"]);
    assert_says(message(&schedule, "guessed-dates"), &["day first"]);
    assert_eq!(schedule.activities.len(), 2);
    let walls = by_id(&schedule, "T1");
    assert_eq!(
        (walls.name.as_str(), &walls.elements[..]),
        ("Walls", &["W1", "W2", "D1"].map(str::to_owned)[..])
    );
    assert_eq!((walls.start, walls.end), (Some(time("2015-02-26")), Some(time("2015-02-28"))));
    // What all rows agree on is said once.
    assert_eq!((field(walls, "Crew"), values(walls, "Crew")), (Some("A"), None));
    assert_eq!(values(walls, "IfcClass"), Some(vec!["IfcWall", "IfcWall", "IfcDoor"]));
    assert_eq!(values(walls, "Element on time"), Some(vec!["On time", "Too late", ""]));
    assert_eq!(walls.element_field("Element on time", 1), Some("Too late"));
    assert_eq!(walls.element_field("Element on time", 2), None);
    assert_eq!(walls.element_field("Crew", 2), Some("A"));
    // Places are those of the rows.
    assert_says(&schedule.element_place(0, 1), &["line 4"]);
    let slab = by_id(&schedule, "T2");
    assert_eq!(field(slab, "Element on time"), Some("Too late"));
    assert!(slab.element_fields.is_empty());
}

#[test]
fn logs_of_other_programs() {
    // XES as a table, semicolons, points in dates, no ids of tasks.
    let schedule = csv("case:concept:name;concept:name;start_timestamp;complete_timestamp\n\
         W1;Walls;3.2.2015 08:00;4.2.2015 17:00\n\
         W2;Walls;3.2.2015 08:00;4.2.2015 17:00\n\
         W3;Walls;5.2.2015 08:00;6.2.2015 17:00\n\
         S1;Slab;1.2.2015;1.2.2015\n");
    assert_eq!(
        findings(&schedule),
        [("event-log", 1), ("guessed-dates", 1), ("guessed-separator", 1)]
    );
    let ids: Vec<&str> = schedule.activities.iter().map(|a| a.id.as_str()).collect();
    let first = "Walls 3.2.2015 08:00 4.2.2015 17:00";
    assert_eq!(ids, [first, "Walls 5.2.2015 08:00 6.2.2015 17:00", "Slab"]);
    assert_eq!(by_id(&schedule, first).elements, ["W1", "W2"]);
    assert_eq!(by_id(&schedule, "Slab").end, Some(time("2015-02-02")));
    let latin = b"Element,Task,Start,Finish\nW\xe4nde,T,2015-02-01,2015-02-02\n";
    let schedule = read_as("log.csv", latin);
    assert_eq!(findings(&schedule), [("event-log", 1), ("guessed-encoding", 1)]);
    assert_eq!(schedule.activities[0].elements, ["W\u{e4}nde"]);
    assert_eq!(schedule.activities[0].name, "T");
}

#[test]
fn what_is_no_log() {
    // A schedule's own headings make a schedule, whatever stands beside them.
    let schedule = csv("id,name,start,end,guid\nA,a,2026-01-01,2026-01-02,W\n");
    assert_eq!(findings(&schedule), []);
    assert_eq!(field(&schedule.activities[0], "guid"), Some("W"));
    // Links with dates stay links.
    let links = "guid,activity_id,start_date,end_date\nW,A,2026-01-01,2026-01-02\n";
    let plan = "id,name,start,end\nA,a,2026-01-01,2026-01-02\n";
    let schedule = Files::new().add("plan.csv", plan).add("links.csv", links).read();
    assert_eq!(schedule.activities[0].elements, ["W"]);
    // Who says what columns mean means a schedule.
    let column = |name: &str, word: &str| {
        (name.to_owned(), topout_schedule::Column::from_word(word).expect("a meaning"))
    };
    let columns = vec![column("task", "id"), column("guid", "name")];
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let text = "guid,task,start,finish\nW,A,2026-01-01,2026-01-02\n";
    let schedule = Files::new().add("plan.csv", text).try_read(&options).expect("a schedule");
    assert_eq!((schedule.activities[0].name.as_str(), findings(&schedule)), ("W", vec![]));
}

#[test]
fn rows_that_differ_are_said() {
    let schedule = csv("guid,task,taskname,start,finish,flag\n\
         W1,T,Walls,2015-02-01,2015-02-02,a\n\
         W2,T,Walls,2015-02-01,2015-02-03,b\n\
         W1,T,Walls,2015-02-01,2015-02-02,b\n\
         W1,T,Walls,2015-02-01,2015-02-02,a\n\
         W3,,,2015-02-01,2015-02-02,a\n\
         ,T,Walls,2015-02-01,2015-02-02,c\n\
         ,,,,,\n");
    assert_eq!(
        findings(&schedule),
        [("differing-element", 1), ("differing-rows", 1), ("event-log", 1), ("incomplete-row", 1)]
    );
    assert_says(message(&schedule, "differing-rows"), &["line 3", "2015-02-03", "\"T\""]);
    assert_says(message(&schedule, "differing-element"), &["line 4", "\"W1\"", "\"b\""]);
    assert_says(message(&schedule, "incomplete-row"), &["line 6", "\"W3\""]);
    let walls = &schedule.activities[0];
    assert_eq!(
        (&walls.elements[..], values(walls, "flag")),
        (&["W1".to_owned(), "W2".to_owned()][..], Some(vec!["a", "b"]))
    );
    assert_eq!(walls.end, Some(time("2015-02-03")));
}

#[test]
fn elements_of_links_files_have_empty_values() {
    let log =
        "guid,task,start,finish,flag\nW1,T,2015-02-01,2015-02-02,a\nW2,T,2015-02-01,2015-02-02,b\n";
    let links = "guid,activity_id\nW2,T\nW3,T\n";
    let schedule = Files::new().add("log.csv", log).add("links.csv", links).read();
    let walls = &schedule.activities[0];
    assert_eq!(walls.elements, ["W1", "W2", "W3"]);
    assert_eq!(values(walls, "flag"), Some(vec!["a", "b", ""]));
    assert_says(&schedule.element_place(0, 2), &["links.csv", "line 3"]);
}

/// Where log and model name elements differently, a links file says which is which.
#[test]
fn elements_of_a_log_get_the_names_of_the_model() {
    let log = "guid,task,start,finish,flag\nL1,T,2015-02-01,2015-02-02,a\n\
               L2,T,2015-02-01,2015-02-02,b\nL1,U,2015-02-01,2015-02-02,c\n";
    let links = "guid,activity_id,log_guid\nM2,T,L2\nM1,T,L1\nM3,T,L3\nM4,T,L1\nM5,U,\n";
    for files in [
        Files::new().add("log.csv", log).add("links.csv", links),
        Files::new().add("log.csv", log).add("links.csv", links).reversed(),
    ] {
        let schedule = files.read();
        let task = by_id(&schedule, "T");
        assert_eq!(task.elements, ["M1", "M2", "M3", "M4"]);
        assert_eq!(values(task, "flag"), Some(vec!["a", "b", "", ""]));
        assert_eq!(by_id(&schedule, "U").elements, ["L1", "M5"]);
        assert_says(&schedule.element_place(0, 0), &["links.csv", "line 3"]);
        assert_says(&schedule.element_place(0, 2), &["links.csv", "line 4"]);
    }
}

#[test]
fn dates_that_cannot_be_read_are_said() {
    let log = "guid,task,start,finish\nW1,T,2015-02-31,2015-02-02\nW2,U,2015-02-01,2015-02-02\n";
    let schedule = csv(log);
    assert_says(message(&schedule, "bad-date"), &["plan.csv: line 2", "2015-02-31", "\"T\""]);
    let none = Files::new().add("log.csv", "guid,task,start,finish\n").read();
    assert_eq!(findings(&none), [("empty-schedule", 1), ("event-log", 1)]);
}

/// A cell that comes late in a task of many rows, in many columns: what is kept is bounded.
#[test]
fn too_many_values_are_refused() {
    let columns: String = (0..250).map(|n| format!(",c{n}")).collect();
    let mut log = format!("guid,task,start,finish{columns},more\n");
    for row in 0..140_000 {
        log.push_str(&format!("{row},T,2015-02-01,2015-02-02\n"));
    }
    log.push_str(&format!("W,T,2015-02-01,2015-02-02{}\n", ",x".repeat(251)));
    let error = Files::new().add("log.csv", log).error();
    assert_says(&error, &["log.csv", "line 140002", "values of single elements"]);
}

#[test]
fn json_says_what_is_wrong_with_element_fields() {
    let with = |fields: &str| {
        json(format!(
            "{{\"activities\": [{{\"id\": \"A\", \"start\": \"2026-01-01\", \"end\": \"2026-01-02\",\n \
             \"elements\": [\"W1\", null, \"W1\", \"W2\"],\n \"element_fields\": {fields}}}]}}"
        ))
    };
    let schedule = with(r#"[{"name": "f", "values": ["a", "b", "c", 4]}]"#);
    assert_eq!(findings(&schedule), []);
    let one = &schedule.activities[0];
    assert_eq!(
        (&one.elements[..], values(one, "f")),
        (&["W1".to_owned(), "W2".to_owned()][..], Some(vec!["a", "4"]))
    );
    let schedule =
        with(r#"[{"name": "f", "values": ["a", "b", "c", "d", "e"]}, 7, {"name": "g"}]"#);
    assert_eq!(findings(&schedule), [("lost-values", 1), ("wrong-type", 2)]);
    assert_says(message(&schedule, "wrong-type"), &["line 3", "a number", "element_fields"]);
    let schedule = with(r#"[{"name": "f", "values": ["a"]}]"#);
    assert_eq!(values(&schedule.activities[0], "f"), Some(vec!["a", ""]));
    assert_eq!(field(&with("\"text\"").activities[0], "element_fields"), Some("text"));
}
