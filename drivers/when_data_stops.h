#pragma once
/// What each output of a rig does when data stops: Luxrig's process dies and nobody stands in for it, or the cable is
/// cut. By a standard, by a product's register map, or not stated by anybody, and then that is said.

#include <optional>
#include <string>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

enum class WithoutData {
  holds,         ///< the lamp keeps its last level for as long as it has power
  goes_dark,     ///< the lamp goes out
  makers_choice  ///< the data's end is noticed, and what follows is set in the fixture or was chosen by its maker
};
[[nodiscard]] const char* name_of(WithoutData does);

struct WhenDataStops {
  WithoutData does = WithoutData::makers_choice;
  std::optional<double> after_s;  ///< after the last data; none: never noticed, or nobody says when
  std::string by;                 ///< which standard, register map or device says so
};

/// What a head does whose axes are on this bus, beside its lamp: it stops where it is.
struct AxesWithoutData {
  bool released = false;  ///< the drives switch off; else they hold their place under current
  double after_s = 0;
  std::string by;
};

struct OutputWithoutData {
  std::size_t fixture = 0;
  WhenDataStops lamp;
  std::optional<AxesWithoutData> axes;
};

/// One for each fixture, in the order of the rig. requires check_buses() to be empty.
[[nodiscard]] std::vector<OutputWithoutData> outputs_without_data(const Rig& rig);

/// "holds its last level", "goes dark after 2 s", "noticed after 2.5 s; then its maker's choice".
[[nodiscard]] std::string told(const WhenDataStops& lamp);
[[nodiscard]] std::string told(const AxesWithoutData& axes);

}  // namespace luxrig
