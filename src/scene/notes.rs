//! Collects [`Note`]s: each code once, with a count and its first place.

use super::Note;

/// Notes in order of first occurrence.
#[derive(Debug, Default)]
pub(crate) struct Notes(Vec<Note>);

impl Notes {
    /// Counts one occurrence of `code`; `message` and `pointer` are kept from the first one.
    pub(crate) fn add(&mut self, code: &'static str, message: &str, pointer: impl FnOnce() -> String) {
        self.add_many(code, 1, message, pointer);
    }

    /// Counts `count` occurrences; zero is nothing.
    pub(crate) fn add_many(
        &mut self,
        code: &'static str,
        count: usize,
        message: &str,
        pointer: impl FnOnce() -> String,
    ) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|note| note.code == code) {
            Some(note) => note.count += count,
            None => self.0.push(Note { code, count, message: message.to_owned(), pointer: pointer() }),
        }
    }

    /// Adds what another collector found, after this one's.
    pub(crate) fn append(&mut self, other: Notes) {
        for Note { code, count, message, pointer } in other.0 {
            self.add_many(code, count, &message, || pointer);
        }
    }

    pub(crate) fn into_vec(self) -> Vec<Note> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_codes_are_counted_together() {
        let mut notes = Notes::default();
        notes.add("A", "first", || "/a".into());
        notes.add_many("B", 0, "never", || "/b".into());
        let mut more = Notes::default();
        more.add_many("A", 2, "second", || "/c".into());
        more.add("C", "other", || "/d".into());
        notes.append(more);
        let seen: Vec<_> = notes.into_vec().into_iter().map(|n| (n.code, n.count, n.pointer)).collect();
        assert_eq!(seen, [("A", 3, "/a".to_owned()), ("C", 1, "/d".to_owned())]);
    }
}
