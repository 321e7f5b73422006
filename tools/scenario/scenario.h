#pragma once
/// A tested show: what happens, and what is expected. The file: rigs/REFERENCE.md, "Scenarios".

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/scene_spec.h"
#include "core/show/show_controller.h"
#include "sim/faults/faults.h"
#include "sim/world/world.h"
#include "tools/recording/recording.h"

namespace luxrig::scenario {

/// Something about the show that is true or not at an instant.
struct Condition {
  enum class Of {
    lux,        ///< true illuminance of points [lx]
    reading,    ///< of luxmeters, as sent [lx]
    level,      ///< of fixtures, as sent, 0…1
    pan,        ///< of heads, true [°]
    tilt,       ///< of heads, true [°]
    lux_hours,  ///< true dose of points since the start [lx h]
    met,        ///< number of goals with that verdict
    missed,     ///< number of goals with that verdict
    unknown,    ///< number of goals with that verdict
    alarms,     ///< number of severe ones
    phase,
    alarm,
    blackout,
    exit  ///< exit code of the daemon that ended last
  };
  enum class Relation { less, at_most, more, at_least, equal, not_equal, between };

  Of of = Of::phase;
  std::vector<std::size_t> which;  ///< points, luxmeters or fixtures of the rig
  Relation relation = Relation::equal;
  double value = 0, most = 0;  ///< between: from value to most, both included
  Phase phase = Phase::idle;
  std::string text;     ///< alarm: part of "device: text"
  std::string written;  ///< as in the file
};

struct Event {
  enum class What {
    apply,
    blackout,
    lift_blackout,
    level,
    goal,
    release,
    park,
    bypass,
    end_bypass,
    desk,
    cover,
    shade,
    daylight,
    clock_step,
    replay,
    stop,
    kill,
    power_cut,
    kill_guardian,
    fault
  };
  std::string name;  ///< empty: nothing refers to it
  // It happens at this time, or so long after another event or the instant at which a condition first holds.
  double at_s = 0;                   ///< if neither of the next two; else the delay
  std::optional<std::size_t> after;  ///< an earlier event
  std::optional<Condition> when;
  What what = What::apply;
  sim::FaultKind fault = sim::FaultKind::silent;
  std::vector<std::string> on;     ///< names; for faults devices of the rig
  std::vector<std::size_t> which;  ///< desk: fixtures; cover: luxmeters; shade: points
  std::optional<double> value, for_s;
  std::optional<double> pan_rad, tilt_rad;  ///< desk
  std::optional<std::filesystem::path> plan;
  std::filesystem::path recording_file;  ///< replay, as written: from the scenario's folder
  std::shared_ptr<const recording::Recording> recording;
  bool refused = false;  ///< the command has to be refused; else it has to be accepted
  FilePosition in_file;
};

struct Expectation {
  enum class Kind { always, never, reached, at_end };
  Kind kind = Kind::always;
  Condition condition;
  std::optional<std::size_t> after;  ///< an event: the time begins with it
  double from_s = 0;
  std::optional<double> within_s;
  std::string why;
  FilePosition in_file;

  /// "always lux drawing-* <= 50".
  [[nodiscard]] std::string text() const;
};

struct Scenario {
  std::filesystem::path file;
  std::string name;
  double length_s = 0;
  std::vector<std::uint64_t> seeds = {1};
  std::string deviations_text = "mild";
  sim::Deviations deviations;
  bool starts_dark = false;
  std::vector<Event> events;
  std::vector<Expectation> expectations;
};

/// As in the file: "at_end", "lift_blackout".
[[nodiscard]] std::string_view name_of(Expectation::Kind kind);
[[nodiscard]] std::string_view name_of(Event::What what);

/// A command to the daemon, which may refuse it.
[[nodiscard]] constexpr bool is_command(Event::What what) { return what <= Event::What::end_bypass; }

}  // namespace luxrig::scenario
