#pragma once
/// Offsets of light domains: 0, step, 2 step …, the thesis's layers.

#include <vector>

namespace luxrig {

inline std::vector<double> even_layers_m(int layers, double step_m = 0.1) {
  std::vector<double> offsets_m;
  for (int layer = 0; layer < layers; ++layer) offsets_m.push_back(layer * step_m);
  return offsets_m;
}

}  // namespace luxrig
