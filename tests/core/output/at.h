#pragma once
#include "core/time.h"

namespace luxrig {

inline Time at(double seconds) { return Time(from_seconds(seconds)); }

}  // namespace luxrig
