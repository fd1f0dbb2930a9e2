//! Proxies of small scenes.
