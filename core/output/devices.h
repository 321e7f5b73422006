#pragma once
/// What the controller needs from the world: five capabilities, and how a device says how it is.
/// Drivers implement them over real buses, sim/ in process.
///
/// No call blocks longer than the bound its driver states (drivers/driver.h). All times are the
/// controller's. Failure is a value; nothing throws.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/frames.h"

namespace luxrig {

/// drive: 0…1, what is sent to a fixture's dimmer after its dimmer curve was undone.
struct LevelCommand {
  std::size_t fixture = 0;  ///< index in the rig
  double drive = 0;
};

class LevelOutput {
 public:
  virtual ~LevelOutput() = default;
  /// Sets and sends. All fixtures of this device in one call, in any order. A NaN, a drive outside 0…1 or a fixture
  /// of another bus: Cause::invalid, and nothing is sent.
  virtual Result<void> write(Time now, std::span<const LevelCommand> commands) = 0;
  /// Every lamp has been told what was written last; false: some is still to come, as a bus takes one after the other.
  [[nodiscard]] virtual bool settled() const { return true; }
};

struct AimCommand {
  std::size_t fixture = 0;
  Joints joints;
};

class Mover {
 public:
  virtual ~Mover() = default;
  /// Sets where heads shall be; sent with the next LevelOutput::write when both travel in one frame. A bus without a
  /// LevelOutput sends here, and wants the call every write_period, with no commands when nothing has been asked yet. A
  /// NaN, an angle outside the travel or a fixture that does not move on this bus: Cause::invalid, and nothing is set.
  virtual Result<void> move(Time now, std::span<const AimCommand> commands) = 0;
};

struct LuxReading {
  std::size_t luxmeter = 0;  ///< index in the rig
  double lux = 0;
  Time taken{};
};

class LuxReader {
 public:
  virtual ~LuxReader() = default;
  /// Whatever is new since the last call, perhaps nothing. One meter that does not answer does not hold back the
  /// others' readings; it shows in the health report. A fault when the whole bus is gone.
  virtual Result<std::vector<LuxReading>> read(Time now) = 0;
};

/// A linear-light picture: samples grow in proportion to the light that fell on them.
struct TakenPicture {
  int width_px = 0, height_px = 0;
  /// Row by row from the top, linear Rec. 709; of a camera without colour three alike. In cd/m² when `calibrated`, else
  /// in shares of what fills a sample at this exposure.
  std::vector<Vec3f> light;
  bool calibrated = false;
  double exposure_s = 0;       ///< as the camera keeps it; 0: not known
  double saturated_share = 0;  ///< of pixels with a full sample: light there is at least what is said
  Time taken{};
};

class PictureTaker {
 public:
  virtual ~PictureTaker() = default;
  /// A picture of which all light fell after the call. Blocks until it is there, at most DriverBounds::read.
  virtual Result<TakenPicture> take(Time now) = 0;
};

/// What Luxrig does with what a lighting desk sends for its fixtures.
enum class DeskMode {
  merge,     ///< the brighter of both; heads look where they were sent last
  takeover,  ///< while the desk is there its values go out instead of Luxrig's
  standby,   ///< the desk drives the lamps itself: Luxrig is silent while it does
};
/// How a desk that comes back gets the light again.
enum class HandBack { at_once, fade, when_asked };
struct DeskRules {
  DeskMode mode = DeskMode::merge;
  HandBack hand_back = HandBack::fade;
};
[[nodiscard]] const char* name_of(DeskMode mode);

/// What a desk wants of one fixture.
struct DeskCommand {
  std::size_t fixture = 0;
  double drive = 0;              ///< 0…1, as in LevelCommand
  std::optional<Joints> joints;  ///< of a head
};
/// unknown: not listened long enough to tell.
enum class DeskPresence { unknown, absent, present };
struct DeskFrame {
  DeskPresence presence = DeskPresence::unknown;
  std::vector<DeskCommand> commands;  ///< the newest, or the last before it was lost; only fixtures it has a say in
  std::string source;                 ///< who that is; empty: nobody yet
};

/// Fixtures that are lost and found together, as one universe is.
struct DeskPart {
  std::string name;                   ///< "dmx, universe 3"
  std::vector<std::size_t> fixtures;  ///< ascending
};

class LevelInput {
 public:
  virtual ~LevelInput() = default;
  [[nodiscard]] virtual DeskRules rules() const = 0;
  [[nodiscard]] virtual std::vector<DeskPart> parts() const = 0;
  /// Takes what has arrived; one frame for each part. Never blocks.
  [[nodiscard]] virtual std::span<const DeskFrame> listen(Time now) = 0;
  /// Whether LevelOutput::write leaves this part out. Says goodbye when it falls silent.
  virtual void set_silent(Time now, std::size_t part, bool silent) = 0;
};

enum class Life { configured, active, faulted };
[[nodiscard]] const char* name_of(Life life);

/// How one device (a bus, a fixture's dimmer, a meter) is.
struct Health {
  std::string device;  ///< name in the rig file
  Life life = Life::configured;
  std::string detail;  ///< empty when well; else cause and figures
  Time since{};        ///< when `life` began
  Time last_ok{};      ///< last successful exchange; Time{} = never
  std::uint64_t sent = 0, received = 0, errors = 0;
};

}  // namespace luxrig
