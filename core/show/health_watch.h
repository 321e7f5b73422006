#pragma once
/// Which devices can be relied on: from what drivers report, and from what the luxmeters say or do not say.
/// Decides nothing about the light; the show does that (show_controller.h).

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"
#include "core/show/show_controller.h"
#include "core/show/trust.h"

namespace luxrig {

class HealthWatch {
 public:
  /// A luxmeter that gave nothing usable for so long is lost. Alarms are up within 2 s.
  static constexpr Duration kSilentAfter = std::chrono::milliseconds(1500);
  /// Time in which nobody here looked, or asked the meter, is not its silence. One that is never asked is lost after:
  static constexpr Duration kUnaskedFor = std::chrono::seconds(10);
  static constexpr Duration kLongestStep = std::chrono::milliseconds(200);

  explicit HealthWatch(const Rig& rig);

  /// Per fixture and luxmeter, something: a person knows of its failure. It raises no alarm, and no light is lost by
  /// it; a luxmeter counts as lost, but not in any_meter_lost().
  void set_bypassed(const std::vector<std::optional<Time>>& lamps, const std::vector<std::optional<Time>>& meters);

  /// The drivers' latest report; replaces the one before.
  void report(std::span<const Health> devices);

  /// A usable reading came from this meter.
  void heard(std::size_t luxmeter, Time taken);
  /// Something came that is no reading (NaN, negative).
  void garbled(std::size_t luxmeter, Time now);
  /// What the model says to the meter's settled reading; why = empty: it can be believed.
  void judged(std::size_t luxmeter, Time now, const std::string& why);

  /// For so long a device may be reported as faulted before it is lost. Alarms do not wait.
  struct Patience {
    Duration lamps{}, meters{};  ///< what turns heads has none: nobody knows where the beam is
  };
  /// Works out the state at `now`; the time of silence counts from the first call.
  void step(Time now, const Patience& patience);
  void step(Time now) { step(now, Patience{}); }

  /// Something was reported as faulted last.
  [[nodiscard]] bool any_faulted() const;

  /// A bus or device that carries light is faulted (or one that the rig does not know).
  [[nodiscard]] bool light_lost() const { return light_lost_; }
  /// Nothing is left that goes on: every fixture is lost, or something that the rig does not know, and perhaps all
  /// hangs on it.
  [[nodiscard]] bool all_lost() const { return all_lost_; }
  /// The bus of its lamp is faulted, or its dimmer.
  [[nodiscard]] bool lamp_lost(std::size_t fixture) const { return lamp_lost_[fixture]; }
  /// The same, or it is in doubt: reported as faulted, for less than its patience.
  [[nodiscard]] bool lamp_silent(std::size_t fixture) const { return lamp_silent_[fixture]; }
  /// It obeys, and its device says that something is wrong with it: its lamp has burnt out, it is too hot.
  [[nodiscard]] bool lamp_failing(std::size_t fixture) const { return lamp_failing_[fixture]; }
  /// What turns it does not hear or obey: its bus, or an axis.
  [[nodiscard]] bool motion_lost(std::size_t fixture) const { return motion_lost_[fixture]; }
  [[nodiscard]] bool any_meter_lost() const;
  [[nodiscard]] bool meter_lost(std::size_t luxmeter) const {
    return meters_[luxmeter].trust.lost() || meters_[luxmeter].bypassed;
  }
  [[nodiscard]] bool meter_implausible(std::size_t luxmeter) const { return !meters_[luxmeter].implausible.empty(); }
  /// One for each cause, whatever hangs on it; a text says nothing that changes while it lasts. Those that carry light
  /// first.
  [[nodiscard]] const std::vector<Alarm>& alarms() const { return alarms_; }

 private:
  struct Meter {
    std::string name;
    std::size_t bus = 0;
    int unit = 0;
    Time heard{}, heard_before{};
    Duration unseen{};               ///< of the time since `heard`: nobody here looked
    std::uint64_t asked_before = 0;  ///< by its driver, when it was heard last
    Time garbled{};
    bool was_garbled = false;
    std::string implausible;  ///< why; empty = believed
    Time implausible_since{};
    Trust trust;
    bool bypassed = false;
  };
  enum class Role { light_bus, axes_bus, meter_bus, bus_part, fixture, axis, luxmeter, unknown };
  struct Known {
    Role role = Role::unknown;
    std::size_t index = 0;
  };

  /// By its name; "BUS: anything" is a part of that bus, such as a node.
  [[nodiscard]] Known known(const std::string& device) const;
  [[nodiscard]] Alarm alarm_of(const Health& health, const Known& known) const;
  void warn_of(const Health& health);
  void join_units();
  void step_meter(Time now, std::size_t luxmeter, bool faulted, Duration patience);
  /// Of a device that answers again, but has failed too often to be relied on at once.
  [[nodiscard]] static Alarm alarm_of_doubted(const std::string& device, const Trust& trust);
  [[nodiscard]] bool all_bypassed_on(std::size_t bus) const;
  void step_trusts(Time now, const Patience& patience);

  const std::map<std::string, Known> known_;
  std::vector<std::size_t> bus_of_fixture_, motion_bus_of_fixture_, fixtures_on_bus_, heads_on_bus_;
  std::vector<std::optional<int>> unit_of_fixture_;  ///< Modbus
  std::vector<std::string> bus_names_;
  std::vector<Meter> meters_;
  struct Counted {
    Trust trust;
    std::uint64_t errors = 0, received = 0;  ///< as reported last
    bool missed = false, answered = true;    ///< between the last two steps
    bool faulted = false;                    ///< as reported last
  };
  std::map<std::string, Counted> counted_;  ///< by device
  std::vector<Health> report_;
  std::vector<Alarm> alarms_;
  std::vector<bool> lamp_bypassed_;                                         ///< per fixture
  std::vector<bool> lamp_lost_, lamp_silent_, lamp_failing_, motion_lost_;  ///< per fixture
  bool light_lost_ = false, all_lost_ = false;
  bool started_ = false;
  Time stepped_{};

  [[nodiscard]] static std::map<std::string, Known> names_of(const Rig& rig);
};

}  // namespace luxrig
