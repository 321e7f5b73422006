#pragma once
/// The controller's interface to devices: five capabilities, and the health of a device. Drivers implement them over
/// real buses, sim/ in process.
///
/// No call blocks longer than the bound that its driver states (drivers/driver.h). All times are the controller's.
/// Failures are values; nothing throws.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/frames.h"

namespace luxrig {

/// drive: 0…1, sent to a fixture's dimmer, after its dimmer curve is undone.
struct LevelCommand {
  std::size_t fixture = 0;  ///< index in the rig
  double drive = 0;
};

class LevelOutput {
 public:
  virtual ~LevelOutput() = default;
  /// Sets and sends. All fixtures of this device in one call, in any order. A NaN, a drive outside 0…1 or a fixture of
  /// another bus: Cause::invalid, and nothing is sent.
  virtual Result<void> write(Time now, std::span<const LevelCommand> commands) = 0;
  /// True if the last write has reached every lamp. False while some are pending, as on a bus that serves one after the
  /// other.
  [[nodiscard]] virtual bool settled() const { return true; }
};

struct AimCommand {
  std::size_t fixture = 0;
  Joints joints;
};

class Mover {
 public:
  virtual ~Mover() = default;
  /// Sets target joints of heads. They are sent with the next LevelOutput::write if both travel in one frame. A bus
  /// without a LevelOutput sends here, and needs the call every write_period, without commands as long as there are
  /// none. A NaN, an angle outside the travel or a fixture that does not move on this bus: Cause::invalid, and nothing
  /// is set.
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
  /// Readings since the last call, perhaps none. A meter that does not answer does not delay the readings of others;
  /// the health report shows it. A fault if the whole bus is gone.
  virtual Result<std::vector<LuxReading>> read(Time now) = 0;
};

/// A linear-light picture: samples are proportional to the light received.
struct TakenPicture {
  int width_px = 0, height_px = 0;
  /// Row by row from the top, linear Rec. 709; a camera without colour gives three equal values. In cd/m² if
  /// `calibrated`, else as a share of the light that fills a sample at this exposure.
  std::vector<Vec3f> light;
  bool calibrated = false;
  double exposure_s = 0;       ///< as the camera reports it; 0 = unknown
  double saturated_share = 0;  ///< of pixels with a full sample: there is at least this much light there
  Time taken{};
};

class PictureTaker {
 public:
  virtual ~PictureTaker() = default;
  /// Takes a picture of light received after the call only. Blocks until it is there, at most DriverBounds::read.
  virtual Result<TakenPicture> take(Time now) = 0;
};

/// How Luxrig treats the values that a lighting desk sends for its fixtures.
enum class DeskMode {
  merge,     ///< the brighter of both; for heads, the latest aim
  takeover,  ///< while the desk is there, its values replace Luxrig's
  standby,   ///< the desk drives the lamps itself; Luxrig is silent while it does
};
/// How a returning desk takes control again.
enum class HandBack { at_once, fade, when_asked };
struct DeskRules {
  DeskMode mode = DeskMode::merge;
  HandBack hand_back = HandBack::fade;
};
[[nodiscard]] const char* name_of(DeskMode mode);

/// A desk's values for one fixture.
struct DeskCommand {
  std::size_t fixture = 0;
  double drive = 0;              ///< 0…1, as in LevelCommand
  std::optional<Joints> joints;  ///< for a head
};
/// unknown: not listened for long enough.
enum class DeskPresence { unknown, absent, present };
struct DeskFrame {
  DeskPresence presence = DeskPresence::unknown;
  std::vector<DeskCommand> commands;  ///< newest, or last before the desk was lost; only fixtures it controls
  std::string source;                 ///< name of the desk; empty = none yet
};

/// Fixtures that are lost and found together, such as one universe.
struct DeskPart {
  std::string name;                   ///< "dmx, universe 3"
  std::vector<std::size_t> fixtures;  ///< ascending
};

class LevelInput {
 public:
  virtual ~LevelInput() = default;
  [[nodiscard]] virtual DeskRules rules() const = 0;
  [[nodiscard]] virtual std::vector<DeskPart> parts() const = 0;
  /// Takes everything that has arrived; one frame per part. Never blocks.
  [[nodiscard]] virtual std::span<const DeskFrame> listen(Time now) = 0;
  /// Whether LevelOutput::write leaves out this part. On falling silent, says goodbye as its protocol wants.
  virtual void set_silent(Time now, std::size_t part, bool silent) = 0;
};

enum class Life { configured, active, faulted };
[[nodiscard]] const char* name_of(Life life);

/// State of one device (a bus, a fixture's dimmer, a meter).
struct Health {
  std::string device;  ///< name in the rig file
  Life life = Life::configured;
  std::string detail;  ///< empty if well; else cause and figures
  Time since{};        ///< when `life` began
  Time last_ok{};      ///< last successful exchange; Time{} = never
  std::uint64_t sent = 0, received = 0, errors = 0;
};

}  // namespace luxrig
