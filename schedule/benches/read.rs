//! What reading costs: `cargo bench --workspace --bench read`.
//!
//! A programme of 100,000 activities with 250,000 links between them, once in each format; as a test
//! (`--test`) one of 1,000. Prints the size of the file and what the schedule takes in memory.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::fmt::Write;
use std::hint::black_box;
use topout_schedule::{ReadOptions, Schedule, Time, read_bytes};

/// Links for each two activities.
const LINKS_OF_TWO: usize = 5;

fn activities() -> usize {
    if std::env::args().any(|a| a == "--test") { 1_000 } else { 100_000 }
}

/// One made-up task.
struct Task {
    number: usize,
    name: String,
    start: Time,
    end: Time,
    /// Numbers of tasks before it.
    predecessors: Vec<usize>,
}

/// Tasks of one to ten days, with two or three predecessors each.
fn tasks() -> impl Iterator<Item = Task> {
    let first = Time::parse_iso("2026-03-02T08:00:00").expect("a date");
    (1..=activities()).map(move |number| {
        let day = |days: usize| first.plus_seconds(days as i64 * 86_400);
        let links = LINKS_OF_TWO / 2 + number % 2 * (LINKS_OF_TWO % 2);
        let before = |k: usize| number.checked_sub(k * 7 + 1).filter(|&n| n > 0);
        Task {
            number,
            name: format!("Reinforced concrete walls, axis {} to {}", number % 40, number % 40 + 1),
            start: day(number / 100),
            end: day(number / 100 + 1 + number % 10).plus_seconds(8 * 3600),
            predecessors: (0..links).filter_map(before).collect(),
        }
    })
}

fn mspdi() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <Project xmlns=\"http://schemas.microsoft.com/project\"><Name>Bench</Name><Tasks>\n",
    );
    for Task { number, name, start, end, predecessors } in tasks() {
        let (summary, level) = if number % 100 == 1 { (1, 1) } else { (0, 2) };
        write!(
            text,
            "<Task><UID>{number}</UID><ID>{number}</ID><Name>{name}</Name><Type>1</Type>\
             <IsNull>0</IsNull><CreateDate>{start}</CreateDate><WBS>1.{number}</WBS>\
             <OutlineNumber>1.{number}</OutlineNumber><OutlineLevel>{level}</OutlineLevel>\
             <Priority>500</Priority><Start>{start}</Start><Finish>{end}</Finish>\
             <Duration>PT16H0M0S</Duration><DurationFormat>7</DurationFormat><Work>PT0H0M0S</Work>\
             <Milestone>0</Milestone><Summary>{summary}</Summary><Critical>0</Critical>\
             <EarlyStart>{start}</EarlyStart><EarlyFinish>{end}</EarlyFinish>\
             <PercentComplete>25</PercentComplete><ActualStart>{start}</ActualStart>\
             <CalendarUID>-1</CalendarUID><Active>1</Active>"
        )
        .expect("memory");
        for predecessor in predecessors {
            write!(
                text,
                "<PredecessorLink><PredecessorUID>{predecessor}</PredecessorUID><Type>1</Type>\
                 <LinkLag>4800</LinkLag><LagFormat>7</LagFormat></PredecessorLink>"
            )
            .expect("memory");
        }
        text.push_str("</Task>\n");
    }
    text + "</Tasks></Project>\n"
}

fn xer() -> String {
    let mut text = String::from(
        "ERMHDR\t22.12\n%T\tPROJECT\n%F\tproj_id\tproj_short_name\n%R\t1\tBENCH\n\
         %T\tPROJWBS\n%F\twbs_id\tparent_wbs_id\twbs_short_name\twbs_name\n%R\t5\t\tB\tBench\n\
         %T\tACTVTYPE\n%F\tactv_code_type_id\tactv_code_type\n%R\t8\tZone\n\
         %T\tACTVCODE\n%F\tactv_code_id\tactv_code_type_id\tshort_name\n%R\t9\t8\tNorth\n\
         %T\tTASK\n%F\ttask_id\tproj_id\twbs_id\tclndr_id\tphys_complete_pct\tcomplete_pct_type\t\
         task_type\tstatus_code\ttask_code\ttask_name\ttotal_float_hr_cnt\tfree_float_hr_cnt\t\
         remain_drtn_hr_cnt\ttarget_drtn_hr_cnt\tcstr_date\tact_start_date\tact_end_date\t\
         late_start_date\tlate_end_date\tearly_start_date\tearly_end_date\ttarget_start_date\t\
         target_end_date\tcstr_type\tguid\n",
    );
    let (mut links, mut codes) = (String::new(), String::new());
    for Task { number, name, start, end, predecessors } in tasks() {
        writeln!(
            text,
            "%R\t{number}\t1\t5\t7\t0\tCP_Drtn\tTT_Task\tTK_NotStart\tA{number:06}\t{name}\t16\t0\t\
             16\t16\t\t\t\t{start}\t{end}\t{start}\t{end}\t{start}\t{end}\t\tygi/8weKMUKMiLdcOaqdlA"
        )
        .expect("memory");
        writeln!(codes, "%R\t{number}\t8\t9").expect("memory");
        for predecessor in predecessors {
            writeln!(links, "%R\t{number}\t{predecessor}\tPR_FS\t8").expect("memory");
        }
    }
    text + "%T\tTASKPRED\n%F\ttask_id\tpred_task_id\tpred_type\tlag_hr_cnt\n"
        + &links
        + "%T\tTASKACTV\n%F\ttask_id\tactv_code_type_id\tactv_code_id\n"
        + &codes
        + "%E\n"
}

fn pmxml() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<APIBusinessObjects><Project><Id>B</Id><ObjectId>1</ObjectId>\n\
         <WBS><Code>B</Code><Name>Bench</Name><ObjectId>5</ObjectId></WBS>\n",
    );
    let mut links = String::new();
    for Task { number, name, start, end, predecessors } in tasks() {
        writeln!(
            text,
            "<Activity><CalendarObjectId>7</CalendarObjectId><FinishDate>{end}</FinishDate>\
             <GUID>{{6A8A1B4C-2F0E-4F0B-9B8E-0C6D1A2B3C4D}}</GUID><Id>A{number:06}</Id>\
             <Name>{name}</Name><ObjectId>{number}</ObjectId><PercentComplete>0</PercentComplete>\
             <PlannedDuration>16</PlannedDuration><PlannedFinishDate>{end}</PlannedFinishDate>\
             <PlannedStartDate>{start}</PlannedStartDate><RemainingDuration>16</RemainingDuration>\
             <StartDate>{start}</StartDate><Status>Not Started</Status><Type>Task Dependent</Type>\
             <WBSObjectId>5</WBSObjectId></Activity>"
        )
        .expect("memory");
        for predecessor in predecessors {
            writeln!(
                links,
                "<Relationship><Lag>8</Lag><PredecessorActivityObjectId>{predecessor}\
                 </PredecessorActivityObjectId><SuccessorActivityObjectId>{number}\
                 </SuccessorActivityObjectId><Type>Finish to Start</Type></Relationship>"
            )
            .expect("memory");
        }
    }
    text + &links + "</Project></APIBusinessObjects>\n"
}

fn ifc() -> String {
    let mut text = String::from("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n");
    for Task { number, name, start, end, predecessors } in tasks() {
        let (task, time, wall, rel) =
            (number * 10, number * 10 + 1, number * 10 + 2, number * 10 + 3);
        writeln!(
            text,
            "#{task}=IFCTASK('0HSpq15hDC2R2R{number:08}',$,'{name}',$,$,'A{number}',$,$,$,.F.,$,#{time},$);\n\
             #{time}=IFCTASKTIME($,.PREDICTED.,$,.WORKTIME.,'P2D','{start}','{end}','{start}','{end}',\
             $,$,$,$,.F.,$,$,$,$,$,$);\n\
             #{wall}=IFCWALL('26tmERtwL8G8UQ{number:08}',$,'Wall',$,$,$,$,$,$);\n\
             #{rel}=IFCRELASSIGNSTOPRODUCT('3fzXeaVoT7R8p4{number:08}',$,$,$,(#{task}),$,#{wall});"
        )
        .expect("memory");
        for (k, predecessor) in predecessors.into_iter().enumerate() {
            let (id, from) = (task + 4 + k, predecessor * 10);
            writeln!(
                text,
                "#{id}=IFCRELSEQUENCE('0y{id:020}',$,$,$,#{from},#{task},$,.FINISH_START.,$);"
            )
            .expect("memory");
        }
    }
    text + "ENDSEC;\nEND-ISO-10303-21;\n"
}

fn read(name: &str, bytes: &[u8]) -> Schedule {
    read_bytes(name.as_ref(), bytes, &ReadOptions::default()).expect("a schedule")
}

fn readers(c: &mut Criterion) {
    let xer = xer();
    let schedule = read("bench.xer", xer.as_bytes());
    let (mut json, mut csv) = (Vec::new(), Vec::new());
    schedule.write_json(&mut json).expect("memory");
    schedule.write_csv(&mut csv).expect("memory");
    drop(schedule);
    let files = [
        ("mspdi", "bench.xml", mspdi().into_bytes()),
        ("xer", "bench.xer", xer.into_bytes()),
        ("pmxml", "bench.xml", pmxml().into_bytes()),
        ("ifc", "bench.ifc", ifc().into_bytes()),
        ("json", "bench.json", json),
        ("csv", "bench.csv", csv),
    ];
    let mut group = c.benchmark_group("read");
    group.sample_size(10);
    for (format, name, bytes) in files {
        let schedule = read(name, &bytes);
        let tally = schedule.tally();
        println!(
            "{format}: {:.1} MB, {} activities, {} links, {} bytes an activity in memory",
            bytes.len() as f64 / 1e6,
            tally.activities,
            tally.predecessors,
            schedule.bytes() / tally.activities
        );
        drop(schedule);
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(format, |b| b.iter(|| black_box(read(name, &bytes)).activities.len()));
    }
    group.finish();
}

criterion_group!(benches, readers);
criterion_main!(benches);
