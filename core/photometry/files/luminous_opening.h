#pragma once
/// Size of the luminous area in a photometric file, as a shape.

#include <string>

#include "core/photometry/shapes/luminous_shape.h"

namespace luxrig {

struct LuminousOpening {
  LuminousShape shape;  ///< in frame lamp; a point if the file gives no size
  std::string note;     ///< simplifications, if no shape fits exactly; empty = none
};

}  // namespace luxrig
