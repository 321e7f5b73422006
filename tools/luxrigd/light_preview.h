#pragma once
/// What the light would be if fixtures had other levels or looked elsewhere. Nothing moves.
///
/// What is predicted now changes by the light that the changed fixtures would give, less what they give now, both by one
/// method: so what the method gets wrong of light that stays cancels. Direct light is exact. Reflected light follows the
/// importance of surfaces (core/transport/candidates/incremental_transport.h), which is made ready once for each rig; for
/// it, luminous areas are points.

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/result.h"
#include "core/show/show_controller.h"
#include "core/tasks/session.h"
#include "core/transport/candidates/incremental_transport.h"

namespace luxrig {

/// What one fixture should do. Names as for levels by hand; an aim turns the whole housing.
struct WantedChange {
  std::string fixture;
  std::optional<double> level{};      ///< 0…1; none = as it is now
  std::optional<Vec3> aim_world_m{};  ///< a point to look at
  std::optional<Joints> joints{};     ///< or pan and tilt; the zoom stays
};

struct PreviewedFixture {
  std::size_t fixture = 0;
  Joints joints;             ///< that reach the aim
  double level = 0;          ///< within its max_level
  bool reached = true;       ///< false: it stays as it is, for `why`
  std::string why;           ///< for a person
  bool by_a_person = false;  ///< it cannot turn by itself
};

struct PreviewedLight {
  std::vector<PreviewedFixture> fixtures;
  std::vector<double> lux;                 ///< per point
  std::vector<double> standard_error_lux;  ///< the same; empty without reflections, as it is not known then
  bool reflections = false;                ///< else reflected light is as now
  std::string text;                        ///< why there are none though asked for; else empty
};

class LightPreview {
 public:
  LightPreview();
  ~LightPreview();
  LightPreview(const LightPreview&) = delete;
  LightPreview& operator=(const LightPreview&) = delete;

  /// show: the light as it is now. One is computed at a time, on the calling thread. Of a client's questions the newest
  /// wins. Any thread but the control thread.
  /// Cause::invalid: a name or angle that is none. Cause::cancelled: a newer question of this client came. Cause::timeout:
  /// another client's is being computed.
  [[nodiscard]] Result<PreviewedLight> light(const std::shared_ptr<const Session>& session, const ShowStatus& show,
                                             const std::vector<WantedChange>& wanted, bool reflections,
                                             const std::string& client);

 private:
  /// Lux at the points at full level.
  struct Column {
    Joints joints;
    bool has_reflected = false;
    Eigen::VectorXd direct_lux, reflected_lux, standard_error_lux;
  };
  /// Reflected light of one rig, made on a thread of its own.
  struct Reflections;

  [[nodiscard]] Result<PreviewedLight> compute(const std::shared_ptr<const Session>& session, const ShowStatus& show,
                                               const std::vector<WantedChange>& wanted, bool reflections,
                                               std::uint64_t question);
  [[nodiscard]] Result<Column> column(const Session& session, std::size_t fixture, const Joints& joints,
                                      const IncrementalTransport* reflected) const;
  /// The same of a fixture as it is now: of a drag, each question has it.
  [[nodiscard]] Result<Column> column_now(const Session& session, std::size_t fixture, const Joints& joints,
                                          const IncrementalTransport* reflected);
  /// Null while they are not ready.
  [[nodiscard]] std::shared_ptr<const IncrementalTransport> reflections_of(
      const std::shared_ptr<const Session>& session, std::string& why_not);
  [[nodiscard]] bool is_newest(std::uint64_t question);

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  bool busy_ = false;
  std::string client_;           ///< of the newest question
  std::uint64_t questions_ = 0;  ///< so far

  // Of the thread that computes.
  std::shared_ptr<const Session> session_;
  std::map<std::size_t, Column> now_;  ///< by fixture
  std::unique_ptr<Reflections> reflections_;
};

}  // namespace luxrig
