#include "core/photometry/files/ies_angles.h"

#include <algorithm>

namespace luxrig {
namespace {

using namespace file_text;

std::string range_text(const std::vector<double>& angles) {
  return number_text(angles.front()) + " to " + number_text(angles.back());
}

bool fits_type_c(const std::vector<double>& horizontal) {
  if (horizontal.size() == 1) return true;
  const double first = horizontal.front();
  const double last = horizontal.back();
  if (first == 0 && (last == 90 || last == 180 || last == 360)) return true;
  if (first == 90 && last == 270) return true;
  double widest = 0;
  for (std::size_t i = 1; i < horizontal.size(); ++i) widest = std::max(widest, horizontal[i] - horizontal[i - 1]);
  // Planes without 360, as 0, 15 … 345: the gap to 360 is one spacing.
  return first == 0 && last > 180 && 360 - last <= 1.01 * widest;
}

}  // namespace

bool check_ies_angles(const IesFile& file, At vertical_at, At horizontal_at, ProblemLog& problems,
                      std::vector<std::string>& warnings) {
  const auto& vertical = file.vertical_deg;
  const auto& horizontal = file.horizontal_deg;
  if (file.type == IesFile::Type::c) {
    if (!fits_type_c(horizontal)) {
      problems.add(horizontal_at, "horizontal angles " + range_text(horizontal) + " fit no symmetry of type C",
                   "start at 0 and end at 0, 90, 180 or 360; or 90 to 270");
    }
    const bool from_edge = vertical.front() == 0 || vertical.front() == 90;
    if (!from_edge || (vertical.back() != 90 && vertical.back() != 180)) {
      warnings.push_back("vertical angles " + range_text(vertical) + " degrees; no light is assumed outside");
    }
    return problems.empty();
  }
  const std::string type = file.type == IesFile::Type::b ? "B" : "A";
  const auto check = [&](const std::string& name, const std::vector<double>& angles, At at) {
    if (angles.front() > 0 || angles.back() <= 0) {
      problems.add(at, name + " angles " + range_text(angles) + " fit no symmetry of type " + type,
                   "give -90 to 90, or 0 to 90 when both sides are alike");
    } else if ((angles.front() != 0 && angles.front() != -90) || angles.back() != 90) {
      warnings.push_back(name + " angles " + range_text(angles) + " degrees; no light is assumed outside");
    }
  };
  check("vertical", vertical, vertical_at);
  if (horizontal.size() > 1) {
    check("horizontal", horizontal, horizontal_at);
  } else if (vertical.front() < 0) {
    problems.add(vertical_at, "one horizontal angle, and vertical angles " + range_text(vertical),
                 "give vertical angles 0 to 90 for a round beam, or more horizontal angles");
  }
  return problems.empty();
}

}  // namespace luxrig
