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
#include <semaphore>
#include <thread>

#include "core/show/show_controller.h"
#include "core/tasks/session.h"
#include "drivers/registry.h"
#include "tools/luxrigd/api/http_api.h"
#include "tools/luxrigd/api/room_view.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/claims.h"
#include "tools/luxrigd/guardian/guardian.h"
#include "tools/luxrigd/rig_file_watch.h"
#include "tools/luxrigd/state/journal.h"
#include "tools/luxrigd/state/light_store.h"

namespace luxrig {

/// A rig's plan, where its heads look, and what the rig gives then.
struct SolvedRig {
  Plan plan;
  KeptLight light;
};

/// What has become of the state that the last daemon left.
struct Resumed {
  bool plan = false;               ///< its plan is in force again
  std::vector<std::string> notes;  ///< for a person
};

struct DaemonOptions {
  bool simulated = false;
  std::map<std::string, Redirect> redirects;          ///< by bus name; empty for the real devices
  std::optional<std::filesystem::path> state_folder;  ///< none: nothing is remembered
  bool guarded = false;  ///< a guardian takes the rig to its safe look when this process dies; needs a state folder
  int http_port = 9620;  ///< 0 = any
  /// A test steps time (clock.h): no threads, no page; tick() is everybody's turn. Makes drivers, too.
  std::function<std::unique_ptr<Driver>(const Rig&, std::size_t bus)> stepped_driver{};
  /// What a rig gives in the session's scene with heads that look elsewhere, for plans that turn them; called on
  /// whatever thread brings the plan. Empty: such plans are refused.
  std::function<Result<LightModel>(const Session&, const std::vector<Joints>&)> light_model{};
  /// Told whenever a model was worked out that is in force now, on whatever thread did it.
  std::function<void(const Session&, const KeptLight&)> keep_light{};
  /// Solves the tasks of a rig file that was read again. Empty: there is no reload.
  std::function<Result<SolvedRig>(const Session&)> solve{};
};

class Daemon {
 public:
  /// light: of the session's rig; its joints may be empty: as the rig file says.
  Daemon(std::shared_ptr<const Session> session, KeptLight light, DaemonOptions options);
  ~Daemon();

  /// Starts drivers and the page; returns the page's port. Sends nothing until the first plan.
  [[nodiscard]] Result<int> start();

  /// Opens the page in one browser, once, within ten minutes.
  [[nodiscard]] std::string page_address() { return http_ ? http_->one_time_address() : ""; }

  /// The plan, the blackout, what rests and what is set by hand as it was when the last daemon stopped, taken up again.
  /// A plan that was solved from a rig file which has changed since is left: the caller has a newer one. One that a
  /// person applied is taken up all the same, within the limits of the rig as it is now, and an alarm says so.
  [[nodiscard]] Resumed resume(const Journal::Left& left);

  /// Applies a plan as if a client had sent it. of_rig: it was solved from this rig file, nobody has chosen it.
  [[nodiscard]] Checked<void> apply(const Plan& plan, bool of_rig = false);

  /// The rig in force, which a reload exchanges.
  [[nodiscard]] std::shared_ptr<const Session> session() const;

  /// Why nobody looks after the light if this process dies although somebody should; empty when all is well.
  [[nodiscard]] const std::string& unguarded() const { return unguarded_; }

  /// Why commands will not find it; empty when all is well.
  [[nodiscard]] std::string unreachable() const { return http_ ? http_->unreachable() : std::string(); }

  /// One turn of the control loop; call every 20 ms or so.
  void tick();
  [[nodiscard]] const ShowStatus& status() const { return status_; }
  [[nodiscard]] const std::vector<Health>& devices() const { return devices_; }
  /// What a client may ask.
  [[nodiscard]] HttpHandlers handlers();

  void go_safe();
  /// Any thread. Past the control thread; returns when every lamp has been told and the disk has it. Fails, though it
  /// holds, where a bus has not taken it, or the disk.
  Result<void> blackout(bool on);
  /// All heads that have a place to rest go there, dark; false: there are none.
  bool park();
  /// Ends output (each driver says goodbye) and the page.
  void stop();

 private:
  struct Command {
    std::function<void(Time)> run;
    std::promise<void> done;
  };
  std::future<void> queue(std::function<void(Time)> run);
  /// Runs what is queued; whether there was anything.
  bool run_commands(Time at);
  void on_control_thread(std::function<void(Time)> run);
  /// Which lamps have not been told, in words; empty: all have.
  [[nodiscard]] std::string wait_until_dark(std::uint64_t order) const;
  /// What `run` gives on the control thread; nothing when that does not come to it. Shared, as nobody waits longer than
  /// a command's bound for it.
  template <class T>
  std::optional<T> ask_control_thread(std::function<T(Time)> run) {
    const auto answer = std::make_shared<std::promise<T>>();
    std::future<T> given = answer->get_future();
    on_control_thread([answer, run = std::move(run)](Time at) { answer->set_value(run(at)); });
    if (given.wait_for(Duration{}) != std::future_status::ready) return std::nullopt;
    return given.get();
  }
  Result<void> identify(const std::string& name, double seconds);
  Result<void> park(const std::vector<std::string>& names);
  Result<std::string> hold(ByHand::What what, const std::vector<std::string>& names, double value,
                           std::optional<double> for_s);
  Result<std::string> release(const std::vector<std::string>& names);
  Result<std::string> bypass(const std::vector<std::string>& names, bool on);
  void restore_bypassed(const std::vector<std::string>& saved, Resumed& resumed);
  [[nodiscard]] Checked<std::string> reload();
  void restore_by_hand(const std::vector<SavedByHand>& saved, Resumed& resumed);
  /// What the controller holds by hand, to be remembered.
  [[nodiscard]] std::vector<SavedByHand> held_by_hand(const Rig& rig, Time at) const;
  void add_alarms(Time at);
  /// A fixture by its name; an emitter's housing stands for its first.
  [[nodiscard]] Result<std::size_t> fixture_called(const std::string& name) const;
  [[nodiscard]] std::string universes_json();
  void send_program();
  void publish(Time at);
  /// What nobody else may have; fails where another has it.
  [[nodiscard]] Result<void> claim_outputs();
  void draw_room_beside();
  [[nodiscard]] OutputOrders orders();
  [[nodiscard]] std::unique_ptr<Driver> make_driver(const Rig& rig, std::size_t bus) const;
  /// Takes what was asked for by a contact, past everything that may wait.
  void watch_contacts(const std::stop_token& stop);
  void add_contact_alarms(Time at);
  void start_guardian(Time at);
  void tell_guardian(Time at);
  void look_after_guardian(Time at);
  /// What becomes of a plan that cannot be saved; is_saved: it is on disk already.
  enum class Unsaved { is_refused, goes_on, is_saved };
  /// plan_json: the same plan as a file, for the journal.
  [[nodiscard]] Checked<std::string> apply(const Plan& plan, const std::string& plan_json, bool of_rig,
                                           Unsaved unsaved);
  /// As a client sent it.
  [[nodiscard]] Checked<std::string> apply_json(const std::string& plan_json);
  /// The look's model: the last one made, when heads looked so then, too.
  [[nodiscard]] Result<LightModel> model_for(const Session& session, const std::vector<Joints>& joints);

  DaemonOptions options_;
  ShowController controller_;
  ProgramMailbox programs_;
  Claims folder_claim_, output_claims_;
  BlackoutSwitch blackout_;
  std::optional<LastLookMemory> guarded_;  ///< shared with the guardian
  std::counting_semaphore<> contact_pressed_{0};
  std::vector<std::optional<Time>> contact_unknown_since_, contact_pressed_since_;  ///< by bus
  std::vector<std::unique_ptr<BusThread>> buses_;
  std::unique_ptr<HttpApi> http_;
  Journal journal_;
  std::optional<Guardian> guardian_;
  std::string unguarded_;
  std::optional<Time> unguarded_since_, stood_still_at_;
  LightInForce last_look_;
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

  std::mutex change_mutex_;  // one plan or rig after the other

  mutable std::mutex mutex_;  // guards what follows
  std::shared_ptr<const Session> session_;
  std::shared_ptr<const Session> first_session_;  ///< drivers and buses look at that rig for ever
  RigVersion version_;                            ///< of session_
  std::optional<RigVersion> plan_made_for_;       ///< of the plan in force
  Time plan_at_{};
  std::shared_ptr<RigFileWatch> rig_file_watch_;
  std::optional<Time> rig_file_changed_at_, unsaved_since_;
  RoomView room_;
  std::string status_json_ = "{}";
  std::deque<Command> commands_;

  std::mutex model_mutex_;  // guards the two below
  KeptLight light_;

  std::jthread drawing_, contacts_;  ///< last: they use what stands above
};

}  // namespace luxrig
