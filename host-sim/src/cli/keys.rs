//! Keys that are pressed while a controller is spoken to, and what they ask for.

use std::io::IsTerminal;
use std::time::Duration;

use crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use shared::link::Action;
use shared::motion::MotionCommand;

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Press {
    /// An action of the controller.
    Act(Action),
    /// q.
    Quit,
    /// ctrl-C.
    Interrupt,
}

/// The keyboard, where there is one; raw as long as this lives.
pub struct Keys {
    raw: bool,
    held: bool,
    single_block: bool,
    percent: u8,
}

impl Keys {
    /// Takes the keyboard, where standard input and standard error are terminals.
    pub fn new() -> Self {
        let raw = std::io::stdin().is_terminal() && std::io::stderr().is_terminal() && enable_raw_mode().is_ok();
        Self { raw, ..Self::none() }
    }

    /// No keyboard.
    pub const fn none() -> Self {
        Self { raw: false, held: false, single_block: false, percent: 100 }
    }

    /// The override as the controller has it: `+` and `-` go on from there.
    pub fn percent_is(&mut self, percent: u8) {
        self.percent = percent;
    }

    /// What was pressed since the last call, if anything was that means something.
    pub fn press(&mut self) -> Option<Press> {
        if !self.raw || !event::poll(Duration::ZERO).unwrap_or(false) {
            return None;
        }
        let Ok(Event::Key(key)) = event::read() else { return None };
        if key.kind == KeyEventKind::Release {
            return None;
        }
        if key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL) {
            return Some(Press::Interrupt);
        }
        self.meaning(key.code)
    }

    fn meaning(&mut self, key: KeyCode) -> Option<Press> {
        let KeyCode::Char(key) = key else { return None };
        let action = match key {
            'q' => return Some(Press::Quit),
            'c' => Action::Motion(MotionCommand::Cancel),
            'h' => self.hold(true),
            'r' => self.hold(false),
            ' ' => self.hold(!self.held),
            '+' => self.change(self.percent.saturating_add(10)),
            '-' => self.change(self.percent.saturating_sub(10)),
            'b' => {
                self.single_block = !self.single_block;
                Action::Motion(MotionCommand::SingleBlock(self.single_block))
            }
            'g' => Action::Home,
            'a' => Action::Acknowledge,
            _ => return None,
        };
        Some(Press::Act(action))
    }

    fn hold(&mut self, held: bool) -> Action {
        self.held = held;
        Action::Motion(if held { MotionCommand::Hold } else { MotionCommand::Resume })
    }

    fn change(&mut self, percent: u8) -> Action {
        self.percent = percent.clamp(10, 200);
        Action::Motion(MotionCommand::Override { percent: self.percent })
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        if self.raw {
            // Nothing better can be done with a terminal that is gone.
            let _ = disable_raw_mode();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_mean_what_the_help_says() {
        let mut keys = Keys::none();
        let mut press = |key| keys.meaning(KeyCode::Char(key));
        let act = |command| Some(Press::Act(Action::Motion(command)));
        assert_eq!(press(' '), act(MotionCommand::Hold));
        assert_eq!(press(' '), act(MotionCommand::Resume));
        assert_eq!(press('h'), act(MotionCommand::Hold));
        assert_eq!(press(' '), act(MotionCommand::Resume));
        assert_eq!(press('+'), act(MotionCommand::Override { percent: 110 }));
        assert_eq!(press('c'), act(MotionCommand::Cancel));
        assert_eq!(press('b'), act(MotionCommand::SingleBlock(true)));
        assert_eq!(press('b'), act(MotionCommand::SingleBlock(false)));
        assert_eq!(press('g'), Some(Press::Act(Action::Home)));
        assert_eq!(press('a'), Some(Press::Act(Action::Acknowledge)));
        assert_eq!(press('q'), Some(Press::Quit));
        assert_eq!(press('x'), None);
        for _ in 0..30 {
            press('-');
        }
        assert_eq!(press('-'), act(MotionCommand::Override { percent: 10 }));
    }
}
