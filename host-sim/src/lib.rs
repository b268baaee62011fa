//! Prepares jobs for the Hodograph motion controller, simulates them with the controller's own tick, measures and reports.
//!
//! The layers, each knowing only those before it:
//!
//! | module | what |
//! | --- | --- |
//! | [`units`] | millimetres and inches, at the border |
//! | [`vector`] | points and directions in space |
//! | [`input`] | files as they are read, and errors that name file, line and column |
//! | [`program`] | programs, one motion after another: RS-274, cutter-location files, Sinumerik, drawings; and written |
//! | [`contour`] | the part's curve: segments and nodes |
//! | [`height`] | how z goes along a segment |
//! | [`offset`] | the exact trimmed offset of a contour |
//! | [`spline`] | splines through points, and ways to drive them at a constant feed |
//! | [`fit`] | curves for the polylines of programs |
//! | [`compensation`] | the path of the tool's centre in the place of a program's contour |
//! | [`strokes`] | a program as the curves of the tool's centre, z and all, and what is done between them |
//! | [`job`] | what a person wants: contour, offset, feed; the contour form |
//! | [`path`] | the exact curves of the tool's centre in f64, and the pieces that a controller gets of them |
//! | [`approach`] | the way to where a job begins |
//! | [`machine`] | a machine's file, and what a controller makes of it |
//! | [`pacing`] | how fast the pace of a path may change within what the axes bear |
//! | [`plan`] | how fast a path may be run within the limits of a machine |
//! | [`prepare`] | a checked job as bytes, for a sender |
//! | [`plant`] | motors, screws, friction, encoders: what hangs on the axes |
//! | [`simulate`] | the tick of `shared` over a path, with or without a plant |
//! | [`controller`] | a controller without hardware, behind a line of bytes |
//! | [`transport`] | the wire to a controller: serial port, file, TCP |
//! | [`stream`] | a job over a transport |
//! | [`session`] | one question after another over a transport |
//! | [`monitor`] | a look at a controller |
//! | [`measure`] | contour error, exact time and peaks of a motion, independent of the kernel |
//! | [`trimming`] | what an offset comes to, in the units of its file |
//! | [`reproduce`] | published experiments beside their published figures |
//! | [`report`] | pictures and tables of results in one HTML file |

pub mod approach;
pub mod compensation;
pub mod contour;
pub mod controller;
pub mod fit;
pub mod height;
pub mod input;
pub mod job;
pub mod machine;
pub mod measure;
pub mod monitor;
pub mod offset;
pub mod pacing;
pub mod path;
pub mod plan;
pub mod plant;
pub mod prepare;
pub mod program;
pub mod report;
pub mod reproduce;
pub mod rig;
pub mod session;
pub mod simulate;
pub mod spline;
pub mod stream;
pub mod strokes;
pub mod transport;
pub mod trimming;
pub mod units;
pub mod vector;
