#pragma once
/// Behaviour of each output of a rig when data stops: Luxrig's process dies without a stand-in, or the cable is cut.
/// The behaviour follows from a standard or from a product's register map; if neither states it, that is reported.

#include <optional>
#include <string>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

enum class WithoutData {
  holds,         ///< the lamp keeps its last level for as long as it has power
  goes_dark,     ///< the lamp goes out
  makers_choice  ///< the fixture notices the loss; its settings or its maker decide what follows
};
[[nodiscard]] const char* name_of(WithoutData does);

struct WhenDataStops {
  WithoutData does = WithoutData::makers_choice;
  std::optional<double> after_s;  ///< after the last data; none = never noticed, or the time is not stated
  std::string by;                 ///< the standard, register map or device that says so
};

/// A head with its axes on this bus stops where it is. Its lamp is a separate matter.
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
