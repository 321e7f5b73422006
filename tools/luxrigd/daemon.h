#pragma once
/// The running rig: drivers on their threads, the controller, the page. One thread (the caller's) drives it with
/// tick().

#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "core/control/show_controller.h"
#include "drivers/registry.h"
#include "tools/luxrig/session.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/guardian.h"
#include "tools/luxrigd/http_api.h"
#include "tools/luxrigd/journal.h"

namespace luxrig {

struct DaemonOptions {
  bool simulated = false;
  std::map<std::string, Redirect> redirects;          ///< by bus name; empty for the real devices
  std::optional<std::filesystem::path> state_folder;  ///< none: nothing is remembered
  bool guarded = false;  ///< a guardian takes the rig to its safe look when this process dies; needs a state folder
  int http_port = 9620;  ///< 0 = any
  /// What the rig gives with heads that look elsewhere, for plans that turn them; called on whatever thread brings the
  /// plan. Empty: such plans are refused.
  std::function<Result<LightModel>(const Rig&)> light_model{};
};

class Daemon {
 public:
  /// The session must outlive the daemon. model: of its rig, with heads as they look there.
  Daemon(const Session& session, LightModel model, DaemonOptions options);
  ~Daemon();

  /// Starts drivers and the page; returns the page's port. Sends nothing until the first plan.
  [[nodiscard]] Result<int> start();

  /// The plan and the blackout that were in force when the last daemon stopped, taken up again. False: there was none.
  [[nodiscard]] Checked<bool> resume();

  /// Applies a plan as if a client had sent it.
  [[nodiscard]] Checked<void> apply(const Plan& plan);

  /// Why nobody looks after the light if this process dies although somebody should; empty when all is well.
  [[nodiscard]] const std::string& unguarded() const { return unguarded_; }

  /// One turn of the control loop; call every 20 ms or so.
  void tick();
  [[nodiscard]] const ShowStatus& status() const { return status_; }
  [[nodiscard]] const std::vector<Health>& devices() const { return devices_; }

  void go_safe();
  /// All heads that have a place to rest go there, dark; false: there are none.
  bool park();
  /// Ends output (each driver says goodbye) and the page.
  void stop();

 private:
  struct Command {
    std::function<void(Time)> run;
    std::promise<void> done;
  };
  void on_control_thread(std::function<void(Time)> run);
  template <class T>
  std::optional<T> ask_control_thread(std::function<T(Time)> run);
  Result<void> identify(const std::string& name, double seconds);
  Result<void> park(const std::vector<std::string>& names);
  /// A fixture by its name; an emitter's housing stands for its first.
  [[nodiscard]] Result<std::size_t> fixture_called(const std::string& name) const;
  [[nodiscard]] std::string universes_json();
  void publish(Time at);
  void start_guardian();
  void tell_guardian(Time at);
  [[nodiscard]] HttpHandlers handlers();
  [[nodiscard]] Checked<void> apply_json(const std::string& plan_json);
  [[nodiscard]] Result<void> remember();
  /// The look's model: the last one made, when heads looked so then, too.
  [[nodiscard]] Result<LightModel> model_for(const PlannedLook& look);

  const Session& session_;
  DaemonOptions options_;
  ShowController controller_;
  ProgramMailbox programs_;
  std::vector<std::unique_ptr<BusThread>> buses_;
  std::unique_ptr<HttpApi> http_;
  std::optional<Journal> journal_;
  std::optional<Guardian> guardian_;
  std::string unguarded_;
  LastLook last_look_;
  std::vector<double> safe_levels_;
  Time safe_look_at_{}, guardian_seen_{};
  int guardian_deaths_ = 0;
  std::thread::id control_thread_ = std::this_thread::get_id();
  Time started_{};
  Time last_publish_{};
  std::uint64_t sent_revision_ = 0;
  std::size_t desks_ = 0;
  bool stopped_ = false;

  ShowStatus status_;            // control thread only
  std::vector<Health> devices_;  // control thread only

  std::mutex mutex_;  // guards the three below
  std::string status_json_ = "{}";
  std::deque<Command> commands_;
  JournalState remembered_;

  std::mutex model_mutex_;  // guards the two below
  std::vector<Joints> model_joints_;
  LightModel model_;
};

}  // namespace luxrig
