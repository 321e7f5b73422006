#pragma once
/// The largest resident set of this process.

namespace luxrig {

/// Since forget_peak(), in GiB; from the kernel.
[[nodiscard]] double peak_gib();
/// Resets the peak. Where the kernel does not allow it, peak_gib() covers the whole process.
void forget_peak();

}  // namespace luxrig
