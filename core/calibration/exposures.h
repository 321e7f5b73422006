#pragma once
/// Pictures of the same light at several exposures, as one.

#include <span>

#include "core/picture/picture.h"

namespace luxrig {

/// longest_first: at least one, of one size (asserted), all in cd/m². Where an exposure is full, the next shorter one
/// counts.
[[nodiscard]] Picture merged_exposures(std::span<const Picture> longest_first);

}  // namespace luxrig
