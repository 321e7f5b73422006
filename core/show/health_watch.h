#pragma once
/// Which devices can be relied on, from driver reports and from the luxmeters' readings or silence. Decides nothing
/// about the light; the show does that (show_controller.h).

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
  /// A luxmeter without a usable reading for this long is lost. Alarms are up within 2 s.
  static constexpr Duration kSilentAfter = std::chrono::milliseconds(1500);
  /// Gaps between steps beyond kLongestStep do not count as a meter's silence, nor does time in which its driver did
  /// not ask it. A meter that is never asked is lost after kUnaskedFor.
  static constexpr Duration kUnaskedFor = std::chrono::seconds(10);
  static constexpr Duration kLongestStep = std::chrono::milliseconds(200);

  explicit HealthWatch(const Rig& rig);
  HealthWatch(const HealthWatch&) = delete;
  HealthWatch& operator=(const HealthWatch&) = delete;

  /// Per fixture and per luxmeter; a value means bypassed. A bypassed device raises no alarm, and its loss is no lost
  /// light. A bypassed luxmeter counts as lost, but not in any_meter_lost().
  void set_bypassed(const std::vector<std::optional<Time>>& lamps, const std::vector<std::optional<Time>>& meters);

  /// The drivers' latest report; replaces the one before.
  void report(std::span<const Health> devices);

  /// A usable reading came from this meter.
  void heard(std::size_t luxmeter, Time taken);
  /// The meter sent something that is no reading (NaN, negative).
  void garbled(std::size_t luxmeter, Time now);
  /// The model's judgement of the meter's settled reading. why: empty = believed. stuck: it does not follow the light.
  void judged(std::size_t luxmeter, Time now, const std::string& why, bool stuck = false);

  /// How long a device may be reported as faulted before it is lost. Alarms do not wait.
  struct Patience {
    Duration lamps{}, meters{};  ///< none for devices that turn heads: the beam may be anywhere
  };
  /// Works out the state at `now`. Silence counts from the first call.
  void step(Time now, const Patience& patience);
  void step(Time now) { step(now, Patience{}); }

  /// The latest report contains a fault.
  [[nodiscard]] bool any_faulted() const;

  /// A bus or device that carries or turns light is lost, unless bypassed, or one that the rig does not know.
  [[nodiscard]] bool light_lost() const { return light_lost_; }
  /// Every fixture in use is lost, or a device that the rig does not know (everything may hang on it).
  [[nodiscard]] bool all_lost() const { return all_lost_; }
  /// Its dimmer or the bus of its lamp is lost.
  [[nodiscard]] bool lamp_lost(std::size_t fixture) const { return lamp_lost_[fixture]; }
  /// The same, or in doubt: reported as faulted for less than its patience.
  [[nodiscard]] bool lamp_silent(std::size_t fixture) const { return lamp_silent_[fixture]; }
  /// It obeys, but its device reports a fault: its lamp has burnt out, or it is too hot.
  [[nodiscard]] bool lamp_failing(std::size_t fixture) const { return lamp_failing_[fixture]; }
  /// Its motion bus or one of its axes is lost: it cannot be turned.
  [[nodiscard]] bool motion_lost(std::size_t fixture) const { return motion_lost_[fixture]; }
  [[nodiscard]] bool any_meter_lost() const;
  /// The same, for another cause than that it shows light that the model does not allow: it is silent, faulted or stuck.
  [[nodiscard]] bool any_meter_gone() const;
  [[nodiscard]] bool meter_lost(std::size_t luxmeter) const {
    return meters_[luxmeter].trust.lost() || meters_[luxmeter].bypassed;
  }
  [[nodiscard]] bool meter_implausible(std::size_t luxmeter) const { return !meters_[luxmeter].implausible.empty(); }
  /// One per cause, whatever hangs on it. A text does not change while the alarm lasts. Order: as reported, then
  /// devices that answer again but are not relied on yet, then silent or implausible luxmeters.
  [[nodiscard]] const std::vector<Alarm>& alarms() const { return alarms_; }
  /// Text of the alarm that says why light is lost, or with of_light = false why a meter is. If none says so, the first
  /// severe alarm's; empty if there is none.
  [[nodiscard]] std::string cause(bool of_light) const;

 private:
  struct Meter {
    std::string name;
    std::size_t bus = 0;
    int unit = 0;
    Time heard{}, heard_before{};
    Duration unseen{};               ///< gaps between steps since `heard`
    std::uint64_t asked_before = 0;  ///< requests by its driver when it was last heard
    Time garbled{};
    bool was_garbled = false;
    std::string implausible;  ///< why; empty = believed
    Time implausible_since{};
    bool stuck = false;
    bool disagrees = false;  ///< what it was lost for last: it answers, and the model does not allow what it shows
    Trust trust;
    bool bypassed = false;
  };
  enum class Role { light_bus, axes_bus, meter_bus, bus_part, fixture, axis, luxmeter, unknown };
  struct Known {
    Role role = Role::unknown;
    std::size_t index = 0;
  };

  /// Looks a device up by name. "BUS: anything" is a part of that bus, such as a node.
  [[nodiscard]] Known known(const std::string& device) const;
  [[nodiscard]] Alarm alarm_of(const Health& health, const Known& known) const;
  void warn_of(const Health& health);
  void join_units();
  void step_meter(Time now, std::size_t luxmeter, bool faulted, Duration patience);
  /// For a device that answers again, but has failed too often to be relied on at once.
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
    Known known;
  };
  std::map<std::string, Counted> counted_;  ///< by device
  std::vector<Health> report_;
  /// The devices of the last report. Drivers report the same ones several times a second, and looking all of them up by
  /// name takes longer than all else here.
  void look_up();
  bool looked_up_ = false;                      ///< for the last report
  std::vector<std::string> reported_;           ///< their names, when they were looked up
  std::vector<Counted*> counted_of_report_;     ///< per entry of the report
  std::vector<Counted*> counted_of_meter_;      ///< per luxmeter; null = it was never reported
  std::vector<const Health*> report_of_meter_;  ///< per luxmeter; null = it is not reported
  std::vector<Alarm> alarms_;
  std::vector<Alarm> worked_out_;  ///< the same by present figures, before the first figures were put in
  std::vector<bool> lamp_bypassed_;                                         ///< per fixture
  std::vector<bool> lamp_lost_, lamp_silent_, lamp_failing_, motion_lost_;  ///< per fixture
  bool light_lost_ = false, all_lost_ = false;
  bool started_ = false;
  Time stepped_{};

  [[nodiscard]] static std::map<std::string, Known> names_of(const Rig& rig);
};

}  // namespace luxrig
