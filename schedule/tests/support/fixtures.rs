//! Small schedules, one a format, that use most of what its reader takes.

/// The outline Site > Shell with two tasks, a milestone without an outline, an inactive task; a
/// percent lag, an elapsed lag, a link with a summary and one that leads nowhere.
pub const MSPDI: &str = r#"<?xml version="1.0" encoding="UTF-8" standalone="yes"?>
<Project xmlns="http://schemas.microsoft.com/project">
 <Name>tower.mpp</Name><Title>Tower &amp; site</Title><StatusDate>2026-03-10T17:00:00</StatusDate>
 <CalendarUID>1</CalendarUID>
 <ExtendedAttributes><ExtendedAttribute><FieldID>188743731</FieldID><FieldName>Text1</FieldName><Alias>Zone</Alias></ExtendedAttribute></ExtendedAttributes>
 <OutlineCodes><OutlineCode><FieldID>188744096</FieldID><FieldName>Outline Code1</FieldName><Values><Value><ValueID>7</ValueID><Value>North</Value></Value></Values></OutlineCode></OutlineCodes>
 <Calendars><Calendar><UID>1</UID><Name>Standard</Name><IsBaseCalendar>1</IsBaseCalendar><BaseCalendarUID>-1</BaseCalendarUID>
  <WeekDays><WeekDay><DayType>1</DayType><DayWorking>0</DayWorking></WeekDay>
   <WeekDay><DayType>2</DayType><DayWorking>1</DayWorking><WorkingTimes><WorkingTime><FromTime>08:00:00</FromTime><ToTime>12:00:00</ToTime></WorkingTime><WorkingTime><FromTime>13:00:00</FromTime><ToTime>00:00:00</ToTime></WorkingTime></WorkingTimes></WeekDay>
   <WeekDay><DayType>0</DayType><DayWorking>0</DayWorking><TimePeriod><FromDate>2026-12-24T00:00:00</FromDate><ToDate>2026-12-26T23:59:00</ToDate></TimePeriod></WeekDay></WeekDays>
  <Exceptions><Exception><TimePeriod><FromDate>2026-12-25T00:00:00</FromDate><ToDate>2026-12-26T23:59:00</ToDate></TimePeriod><Name>Christmas</Name><Type>1</Type><DayWorking>0</DayWorking></Exception>
   <Exception><TimePeriod><FromDate>2026-05-01T00:00:00</FromDate><ToDate>2030-05-01T23:59:00</ToDate></TimePeriod><Type>2</Type><DayWorking>0</DayWorking></Exception></Exceptions></Calendar>
  <Calendar><UID>2</UID><Name>Crane</Name><IsBaseCalendar>0</IsBaseCalendar><BaseCalendarUID>1</BaseCalendarUID></Calendar></Calendars>
 <Tasks>
  <Task><UID>0</UID><ID>0</ID><Name>Tower</Name><OutlineLevel>0</OutlineLevel><Summary>1</Summary></Task>
  <Task><UID>1</UID><ID>1</ID><Name>Site</Name><OutlineNumber>1</OutlineNumber><OutlineLevel>1</OutlineLevel><Summary>1</Summary><WBS>S</WBS></Task>
  <Task><UID>2</UID><ID>2</ID><Name>Shell</Name><OutlineNumber>1.1</OutlineNumber><OutlineLevel>2</OutlineLevel></Task>
  <Task><UID>3</UID><ID>3</ID><Name>Walls &lt;north&gt;</Name><OutlineLevel>3</OutlineLevel><Duration>PT16H0M0S</Duration><Start>2026-03-02T08:00:00</Start><Finish>2026-03-03T17:00:00</Finish><ActualStart>2026-03-03T08:00:00</ActualStart><ActualFinish>NA</ActualFinish><PercentComplete>40</PercentComplete><CalendarUID>2</CalendarUID><Notes><![CDATA[wet & cold]]></Notes>
   <Baseline><Number>0</Number><Start>2026-02-23T08:00:00</Start><Finish>2026-02-24T17:00:00</Finish></Baseline><Baseline><Number>1</Number><Start>2020-01-01T08:00:00</Start></Baseline>
   <ExtendedAttribute><FieldID>188743731</FieldID><Value>A&#228;</Value></ExtendedAttribute><OutlineCode><FieldID>188744096</FieldID><ValueID>7</ValueID></OutlineCode></Task>
  <Task><UID>4</UID><ID>4</ID><Name/><OutlineLevel>3</OutlineLevel><Start>2026-03-04T08:00:00</Start><Finish>2026-03-05T17:00:00</Finish>
   <PredecessorLink><PredecessorUID>3</PredecessorUID><Type>1</Type><LinkLag>50</LinkLag><LagFormat>19</LagFormat></PredecessorLink>
   <PredecessorLink><PredecessorUID>5</PredecessorUID><Type>3</Type><LinkLag>-14400</LinkLag><LagFormat>8</LagFormat></PredecessorLink>
   <PredecessorLink><PredecessorUID>1</PredecessorUID><Type>1</Type></PredecessorLink><PredecessorLink><PredecessorUID>99</PredecessorUID></PredecessorLink></Task>
  <Task><UID>8</UID><IsNull>1</IsNull></Task>
  <Task><UID>5</UID><ID>5</ID><Name>Handover</Name><OutlineLevel>1</OutlineLevel><Milestone>1</Milestone><Finish>2026-03-06T17:00:00</Finish></Task>
  <Task><UID>6</UID><ID>6</ID><Name>Walls &lt;north&gt;</Name><OutlineLevel>1</OutlineLevel><Active>0</Active></Task>
 </Tasks>
</Project>
"#;

/// Two projects, of which one is a baseline of the other.
pub const XER: &str = "ERMHDR\t22.12\t2026-03-01\tProject\tADMIN\r
%T\tPROJECT\r
%F\tproj_id\tproj_short_name\tclndr_id\torig_proj_id\tlast_recalc_date\tplan_start_date\r
%R\t10\tTOWER\t7\t\t2026-03-10 17:00\t2026-03-01 00:00\r
%R\t11\tTOWER-B1\t7\t10\t2026-01-10 17:00\t\r
%T\tCALENDAR\r
%F\tclndr_id\tclndr_name\tbase_clndr_id\tclndr_data\r
%R\t7\t5 days\t8\t(0||CalendarData()((0||DaysOfWeek()((0||1()())(0||2()((0||0(s|08:00|f|12:00)())(0||1(s|13:00|f|17:00)())))))(0||Exceptions()((0||0(d|46015)())))))\r
%R\t8\tGlobal\t\t(0||CalendarData()((0||Exceptions()((0||0(d|46023)())))))\r
%T\tPROJWBS\r
%F\twbs_id\tproj_id\tparent_wbs_id\twbs_short_name\twbs_name\r
%R\t102\t10\t101\tSH\tShell\r
%R\t101\t10\t\tTOWER\tTower\r
%R\t103\t10\t104\tX\tring\r
%R\t104\t10\t103\tY\tring\r
%T\tACTVTYPE\r
%F\tactv_code_type_id\tactv_code_type\r
%R\t30\tLocation\r
%T\tACTVCODE\r
%F\tactv_code_id\tactv_code_type_id\tshort_name\tactv_code_name\r
%R\t31\t30\tL03\tLevel 3\r
%T\tUDFTYPE\r
%F\tudf_type_id\ttable_name\tudf_type_label\r
%R\t40\tTASK\tCrew\r
%R\t41\tPROJECT\tOwner\r
%T\tTASK\r
%F\ttask_id\tproj_id\twbs_id\tclndr_id\tphys_complete_pct\tcomplete_pct_type\ttask_type\tstatus_code\ttask_code\ttask_name\tremain_drtn_hr_cnt\ttarget_drtn_hr_cnt\tact_start_date\tact_end_date\tearly_start_date\tearly_end_date\ttarget_start_date\ttarget_end_date\r
%R\t1\t10\t102\t7\t0\tCP_Drtn\tTT_Task\tTK_Active\tA10\tWalls, S\u{fc}d\t10\t40\t2026-03-03 08:00\t\t2026-03-04 08:00\t2026-03-09 17:00\t2026-03-02 08:00\t2026-03-06 17:00\r
%R\t2\t10\t102\t7\t25,5\tCP_Phys\tTT_FinMile\tTK_NotStart\tA20\tDone\t0\t0\t\t\t\t2026-03-09 17:00\t\t2026-03-06 17:00\r
%R\t3\t10\t999\t9\t0\tCP_Drtn\tTT_WBS\tTK_Complete\tA30\t\t0\t8\t2026-03-03 08:00\t2026-03-09 17:00\t\t\t2026-03-02 08:00\t2026-03-06 17:00\r
%R\t21\t11\t\t\t0\tCP_Drtn\tTT_Task\tTK_NotStart\tA10\tWalls\t40\t40\t\t\t\t\t2026-02-02 08:00\t2026-02-06 17:00\r
%T\tTASKACTV\r
%F\ttask_id\tactv_code_type_id\tactv_code_id\r
%R\t1\t30\t31\r
%T\tTASKPRED\r
%F\ttask_pred_id\ttask_id\tpred_task_id\tpred_type\tlag_hr_cnt\r
%R\t50\t2\t1\tPR_FF\t-8\r
%R\t51\t2\t77\tPR_FS\t0\r
%R\t52\t78\t1\tPR_FS\t0\r
%T\tUDFVALUE\r
%F\tudf_type_id\tfk_id\tudf_text\tudf_number\r
%R\t40\t1\t\t12.5\r
%E\r
";

/// The same as [`XER`], as far as it goes.
pub const PMXML: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<APIBusinessObjects xmlns="http://xmlns.oracle.com/Primavera/P6/V22.12/API/BusinessObjects" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
 <ActivityCodeType><Name>Location</Name><ObjectId>30</ObjectId></ActivityCodeType>
 <ActivityCode><CodeTypeObjectId>30</CodeTypeObjectId><CodeValue>L03</CodeValue><Description>Level 3</Description><ObjectId>31</ObjectId></ActivityCode>
 <UDFType><ObjectId>40</ObjectId><SubjectArea>Activity</SubjectArea><Title>Crew</Title></UDFType>
 <Calendar><Name>5 days</Name><ObjectId>7</ObjectId><BaseCalendarObjectId xsi:nil="true"/>
  <StandardWorkWeek><StandardWorkHours><DayOfWeek>Sunday</DayOfWeek></StandardWorkHours><StandardWorkHours><DayOfWeek>Monday</DayOfWeek><WorkTime><Start>08:00:00</Start><Finish>11:59:00</Finish></WorkTime><WorkTime><Start>13:00:00</Start><Finish>16:59:00</Finish></WorkTime></StandardWorkHours></StandardWorkWeek>
  <HolidayOrExceptions><HolidayOrException><Date>2025-12-25T00:00:00</Date></HolidayOrException></HolidayOrExceptions></Calendar>
 <Project><ActivityDefaultCalendarObjectId>7</ActivityDefaultCalendarObjectId><DataDate>2026-03-10T17:00:00</DataDate><Id>TOWER</Id><Name>Tower</Name><ObjectId>10</ObjectId>
  <WBS><Code>SH</Code><Name>Shell</Name><ObjectId>102</ObjectId><ParentObjectId>101</ParentObjectId></WBS>
  <WBS><Code>TOWER</Code><Name>Tower</Name><ObjectId>101</ObjectId><ParentObjectId xsi:nil="true"/></WBS>
  <Activity><ActualStartDate>2026-03-03T08:00:00</ActualStartDate><ActualFinishDate xsi:nil="true"/><CalendarObjectId>7</CalendarObjectId><FinishDate>2026-03-09T17:00:00</FinishDate><Id>A10</Id><Name>Walls</Name><ObjectId>1</ObjectId><PercentComplete>0.75</PercentComplete><PlannedFinishDate>2026-03-06T17:00:00</PlannedFinishDate><PlannedStartDate>2026-03-02T08:00:00</PlannedStartDate><StartDate>2026-03-03T08:00:00</StartDate><Status>In Progress</Status><Type>Task Dependent</Type><WBSObjectId>102</WBSObjectId><Code><TypeObjectId>30</TypeObjectId><ValueObjectId>31</ValueObjectId></Code><UDF><TypeObjectId>40</TypeObjectId><Double>12.5</Double></UDF></Activity>
  <Activity><Id>A20</Id><Name>Done</Name><ObjectId>2</ObjectId><PlannedFinishDate>2026-03-06T17:00:00</PlannedFinishDate><Type>Finish Milestone</Type><WBSObjectId>102</WBSObjectId></Activity>
  <Relationship><Lag>-8</Lag><ObjectId>50</ObjectId><PredecessorActivityObjectId>1</PredecessorActivityObjectId><SuccessorActivityObjectId>2</SuccessorActivityObjectId><Type>Finish to Finish</Type></Relationship>
  <Relationship><PredecessorActivityObjectId>77</PredecessorActivityObjectId><SuccessorActivityObjectId>2</SuccessorActivityObjectId><Type>Finish to Start</Type></Relationship>
 </Project>
 <BaselineProject><Id>TOWER-B1</Id><Name>Tower - B1</Name><ObjectId>11</ObjectId><OriginalProjectObjectId>10</OriginalProjectObjectId>
  <WBS><Code>SH</Code><Name>Shell</Name><ObjectId>202</ObjectId></WBS>
  <Activity><Id>A10</Id><ObjectId>21</ObjectId><PlannedFinishDate>2026-02-06T17:00:00</PlannedFinishDate><PlannedStartDate>2026-02-02T08:00:00</PlannedStartDate></Activity>
 </BaselineProject>
</APIBusinessObjects>
"#;

/// A summary with a storey, two tasks below it, one of them with a lag, and what is not for schedules.
pub const IFC: &str = r"ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('ViewDefinition [x;y]'),'2;1');
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
/* #1=IFCTASK('comment; '); */
#1=IFCPROJECT('0p',$,'T\X\FCrme',$,$,$,$,$,$);
#2=IFCRELSEQUENCE('0a',$,$,$,#20,#30,#40,.START_START.,$);
#3=IFCCARTESIANPOINT((0.,1.E-5,-3.));
#10=IFCTASK('1summary',$,'Shell',$,$,'S',$,$,$,.F.,$,$,$);
#20=IFCTASK('2walls',$,'Walls /* no comment */',$,$,'W',$,'done',$,.F.,$,#21,.INSTALLATION.);
#21=IFCTASKTIME($,.PREDICTED.,$,.WORKTIME.,'P2D','2026-03-02T08:00:00','2026-03-03T17:00:00+01:00',$,$,$,$,$,$,.T.,'2026-03-10T17:00:00',$,'2026-03-03T08:00:00',$,$,IFCPOSITIVERATIOMEASURE(0.5));
#30=IFCTASK('3gone',$,'It''s gone',$,$,$,$,$,$,.T.,$,#31,.DEMOLITION.);
#31=IFCTASKTIME($,$,$,$,$,$,$,'2026-03-04T08:00:00','2026-03-05T17:00:00',$,$,$,$,$,$,$,$,$,$,$);
#40=IFCLAGTIME($,$,$,IFCDURATION('-PT4H'),.ELAPSEDTIME.);
#50=IFCRELNESTS('0n',$,$,$,#10,(#20,#30));
#60=IFCRELASSIGNSTOPRODUCT('0s',$,$,$,(#10),$,#70);
#61=IFCRELASSIGNSTOPROCESS('0w',$,$,$,(#71,#72),$,#20,$);
#62=IFCRELSEQUENCE('0b',$,$,$,#99,#30,$,$,$);
#70=IFCBUILDINGSTOREY('G-storey',$,'Ground',$,$,$,$,$,.ELEMENT.,0.);
#71=IFCWALL('G-wall',$,'Wall',$,$,$,$,$,$);
#72=IFCLABORRESOURCE('G-crew',$,$,$,$,$,$,$,$,$,$);
ENDSEC;
END-ISO-10303-21;
";

pub const JSON: &str = r#"{"format": "4d-schedule", "version": 1, "project": "Tower", "data_date": "2026-03-10",
 "wbs": [{"code": "S", "name": "Site"}, {"code": "SH", "parent": 0}],
 "calendars": [{"name": "5 days", "week": {"mon": ["08:00-12:00", "13:00-17:00"]},
                "exceptions": [{"first": "2026-12-24", "last": "2026-12-26"}]}], "calendar": 0,
 "activities": [
  {"id": "A10", "name": "Walls \"north\"", "planned_start": "2026-03-02", "planned_end": "2026-03-06",
   "actual_start": "2026-03-03T08:00", "wbs": 1, "calendar": 0, "percent_complete": 62.5, "elements": ["W1"]},
  {"id": "A20", "start": "2026-03-06", "end": "2026-03-06", "milestone": true, "crew": [1, {"a": 2}],
   "predecessors": ["A10", {"id": "A10", "type": "FF", "lag": -3600, "elapsed": true}, "Z"]}]}
"#;

pub const CSV: &str = "Task;Title;Begin;Finish;Planned;Done;Path;After;elements;trade\r
A10;\"Walls; north\";2.3.2026;06.03.2026;1.3.2026;62,5 %;Site/Shell;;W1|W2;Masonry\r
A20;Done;6.3.2026 17:00;06.03.2026 17:00;;;Site/Shell;A10:FF-1h, Z;;\r
";

/// A row for each element of each task.
pub const LOG: &str = "GUID;IfcClass;TaskID;TaskName;TaskStart;TaskFinish;On time or not\r
W1;IfcWall;T1;\"Walls; north\";26-2-2015;27-2-2015 16:30;On time\r
S1;IfcSlab;T2;Slab;2-3-2015;2-3-2015;Too late\r
W2;IfcWall;T1;\"Walls; north\";26-2-2015;27-2-2015 16:30;Too late\r
;;;;;;\r
R1;IfcRoof;;Roof;2.3.2015;3.3.2015;\r
";
