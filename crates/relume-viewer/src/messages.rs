//! What a person should know, until they have read it.

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Good to know.
    Note,
    /// Something went wrong.
    Error,
}

/// A single line of plain text: never markup, whatever file it speaks of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// How serious it is.
    pub weight: Weight,
    /// What it says.
    pub text: String,
    /// What it stands for, if it goes by itself.
    about: Option<&'static str>,
}

/// The most messages at a time: the oldest go first.
const MOST: usize = 6;

/// All messages that are shown, the newest last.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    /// In the order they came.
    pub shown: Vec<Message>,
}

impl Messages {
    /// Adds a note.
    pub fn note(&mut self, text: String) {
        self.add(Weight::Note, text, None);
    }

    /// Adds an error.
    pub fn error(&mut self, text: String) {
        self.add(Weight::Error, text, None);
    }

    /// Shows an error as long as it is said: the next call about the same takes its place, or takes it away.
    pub fn standing(&mut self, about: &'static str, text: Option<String>) {
        self.stand(Weight::Error, about, text);
    }

    /// Shows a note as [`Self::standing`] does an error.
    pub fn standing_note(&mut self, about: &'static str, text: Option<String>) {
        self.stand(Weight::Note, about, text);
    }

    fn stand(&mut self, weight: Weight, about: &'static str, text: Option<String>) {
        let same = |m: &Message| m.about == Some(about) && Some(&m.text) == text.as_ref();
        if self.shown.iter().any(same) {
            return;
        }
        self.shown.retain(|message| message.about != Some(about));
        if let Some(text) = text {
            self.add(weight, text, Some(about));
        }
    }

    /// The oldest error.
    #[cfg_attr(
        target_arch = "wasm32",
        allow(dead_code, reason = "a page does not end")
    )]
    pub fn first_error(&self) -> Option<&str> {
        let mut errors = self.shown.iter().filter(|m| m.weight == Weight::Error);
        errors.next().map(|message| message.text.as_str())
    }

    fn add(&mut self, weight: Weight, text: String, about: Option<&'static str>) {
        if self.shown.iter().any(|m| m.text == text) {
            return;
        }
        if self.shown.len() == MOST {
            self.shown.remove(0);
        }
        self.shown.push(Message {
            weight,
            text,
            about,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standing_messages_come_and_go_and_the_same_is_said_once() {
        let mut messages = Messages::default();
        messages.error("broken".to_owned());
        messages.error("broken".to_owned());
        messages.standing("window", Some("negative".to_owned()));
        messages.standing("window", Some("negative".to_owned()));
        assert_eq!(messages.shown.len(), 2);
        messages.standing("window", None);
        assert_eq!(messages.shown.len(), 1);
        messages.standing_note("near", Some("waits".to_owned()));
        assert_eq!(messages.shown[1].weight, Weight::Note);
        assert_eq!(messages.first_error(), Some("broken"));
        for i in 0..20 {
            messages.note(i.to_string());
        }
        assert_eq!(messages.shown.len(), MOST);
        assert_eq!(messages.first_error(), None);
    }
}
