//! The page's look: light, readable on a phone and on paper.

use super::svg::Look;
use crate::evaluate::method::EvaluationMethod;

/// Colours by Okabe and Ito (2008), which colour-blind people can tell apart too.
pub(super) fn look(method: EvaluationMethod) -> Look {
    match method {
        EvaluationMethod::Nothing => Look { color: "#999999", dashes: "2 3" },
        EvaluationMethod::Frustum => Look { color: "#d55e00", dashes: "" },
        EvaluationMethod::Visibility => Look { color: "#0072b2", dashes: "" },
        EvaluationMethod::Exact => Look { color: "#009e73", dashes: "7 3" },
        EvaluationMethod::Budget => Look { color: "#cc79a7", dashes: "" },
        EvaluationMethod::FirstMisfit => Look { color: "#000000", dashes: "3 2" },
        EvaluationMethod::Proxies => Look { color: "#e69f00", dashes: "" },
        EvaluationMethod::ProxiesSse => Look { color: "#56b4e9", dashes: "9 3" },
        EvaluationMethod::ProxiesLinear => Look { color: "#009e73", dashes: "2 2" },
        EvaluationMethod::ProxiesFrustum => Look { color: "#d55e00", dashes: "5 3" },
    }
}

pub(super) const CSS: &str = "\
:root{color-scheme:light}
*{box-sizing:border-box}
body{margin:0 auto;padding:1rem;max-width:74rem;font:16px/1.5 system-ui,sans-serif;color:#1a1a1a;background:#fff}
h1{font-size:1.5rem;margin:.5rem 0;overflow-wrap:anywhere}
h2{font-size:1.2rem;margin:2rem 0 .5rem;border-bottom:1px solid #ccc}
h3{font-size:1rem;margin:1.2rem 0 .3rem}
p{margin:.4rem 0;max-width:48rem}
.note{background:#fff6e0;border-left:4px solid #e69f00;padding:.4rem .7rem}
.wide{overflow-x:auto}
table{border-collapse:collapse;font-size:.8rem;font-variant-numeric:tabular-nums}
th,td{padding:.2rem .42rem;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}
th:first-child,td:first-child{text-align:left}
thead th{border-bottom:2px solid #666;vertical-align:bottom}
table.facts th,table.facts td{text-align:left;white-space:normal;vertical-align:top}
table.facts th{font-weight:600;white-space:nowrap}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,25rem),1fr));gap:.8rem}
svg{width:100%;height:auto;display:block}
svg text{font:11.5px system-ui,sans-serif;fill:#1a1a1a}
svg .t{font-weight:600;font-size:13px}
.g{stroke:#e3e3e3;stroke-width:1}
.a{stroke:#666;stroke-width:1;fill:none}
.l{fill:none;stroke-width:2;stroke-linejoin:round}
.legend{display:flex;flex-wrap:wrap;gap:.2rem 1.2rem;font-size:.9rem;margin:.4rem 0}
.legend span{display:inline-flex;align-items:center;gap:.4rem}
.legend svg{width:2.4rem;height:.8rem}
.three{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,20rem),1fr));gap:.6rem}
figure{margin:0}
img{width:100%;height:auto;display:block;border:1px solid #ccc}
figcaption{font-size:.85rem;color:#333}
small,.quiet{color:#555;font-size:.85rem}
@media print{body{max-width:none;padding:0;font-size:11pt}.plots{grid-template-columns:1fr 1fr}
.three{grid-template-columns:1fr 1fr 1fr}.wide{overflow:visible}table{font-size:7.5pt}
th,td{padding:.1rem .25rem}.plots>*,.worst,table{break-inside:avoid}}
";
