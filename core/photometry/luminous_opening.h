#pragma once
/// What a photometric file says of the size of its light, as a shape.

#include <string>

#include "core/photometry/luminous_shape.h"

namespace luxrig {

struct LuminousOpening {
  LuminousShape shape;  ///< in frame lamp; a point when the file gives no size
  std::string note;     ///< what had to be simplified, since no shape is quite like it; empty: nothing
};

}  // namespace luxrig
