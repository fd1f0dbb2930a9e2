//! How much memory this process has used.

/// Largest resident set of this process so far, in bytes, as Linux counts it; `None` elsewhere.
pub(crate) fn peak() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_high_water_mark() {
        assert_eq!(
            peak_of("Name:\tsvs\nVmPeak:\t  99 kB\nVmHWM:\t    2048 kB\nVmRSS:\t 7 kB\n"),
            Some(2048 * 1024)
        );
        assert_eq!(peak_of("Name:\tsvs\n"), None);
        assert_eq!(peak_of("VmHWM:\t many kB\n"), None);
    }
}
