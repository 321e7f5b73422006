#pragma once
/// The running rig: drivers on their threads, the controller, the page. One thread, the caller's, drives it with
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
#include "tools/luxrigd/api/status_changes.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/claims.h"
#include "tools/luxrigd/guardian/guardian.h"
#include "tools/luxrigd/hand_question.h"
#include "tools/luxrigd/light_preview.h"
#include "tools/luxrigd/rig_file_watch.h"
#include "tools/luxrigd/state/change_log.h"
#include "tools/luxrigd/state/journal.h"
#include "tools/luxrigd/state/light_store.h"

namespace luxrig {

/// The state of the rig as clients get it. Its JSON is made where it is asked for: the control loop has no time for it.
struct PublishedStatus;

/// Outcome of taking up the state that the last daemon left.
struct Resumed {
  bool plan = false;               ///< its plan is in force again
  std::vector<std::string> notes;  ///< for a person
};

struct DaemonOptions {
  bool simulated = false;
  std::optional<Redirect> sim_control{};              ///< of the simulated rig: where it gives pictures
  std::map<std::string, Redirect> redirects;          ///< by bus name; empty for the real devices
  std::optional<std::filesystem::path> state_folder;  ///< none = nothing is remembered
  bool guarded = false;  ///< a guardian takes the rig to its safe look when this process dies; needs a state folder
  int http_port = 9620;  ///< 0 = any
  /// For tests that step time (clock.h): makes the drivers; no threads, no page, and tick() also runs each bus.
  std::function<std::unique_ptr<Driver>(const Rig&, std::size_t bus)> stepped_driver{};
  /// Light model of the session's rig for heads at these joints. Called on the thread that brings the plan.
  std::function<Result<LightModel>(const Session&, const std::vector<Joints>&)> light_model{};
  /// Solves the tasks of a rig. If empty, reloads and jobs are refused.
  /// Heeds watch.stop. Called on any thread.
  std::function<Result<Plan>(const Session&, const Watch&)> solve{};
};

class Daemon {
 public:
  /// light: of the session's rig. Empty joints mean the aims in the rig file.
  Daemon(std::shared_ptr<const Session> session, const KeptLight& light, DaemonOptions options);
  ~Daemon();

  /// Starts drivers and the page and returns the page's port. Sends nothing before the first plan.
  [[nodiscard]] Result<int> start();

  /// Address that opens the page in one browser, once, within ten minutes.
  [[nodiscard]] std::string page_address() { return http_ ? http_->one_time_address() : ""; }

  /// Restores the state in which the last daemon stopped: plan, blackout, parked heads, levels and goals set by hand,
  /// bypassed devices. A plan that was solved from a rig file which has changed since is dropped: the caller has a
  /// newer one. A plan that a person applied is kept, within the limits of the present rig, and an alarm says so.
  [[nodiscard]] Resumed resume(const Journal::Left& left);

  /// Applies a plan as if a client had sent it. of_rig: it was solved from this rig file, not chosen by a person.
  [[nodiscard]] Checked<void> apply(const Plan& plan, bool of_rig = false);

  /// The rig in force; a reload exchanges it.
  [[nodiscard]] std::shared_ptr<const Session> session() const;

  /// Why no guardian runs although one should; empty if all is well.
  [[nodiscard]] const std::string& unguarded() const { return unguarded_; }

  /// Why commands will not find this daemon; empty if all is well.
  [[nodiscard]] std::string unreachable() const { return http_ ? http_->unreachable() : std::string(); }

  /// Why nobody can log in although there are accounts; empty if all is well.
  [[nodiscard]] std::string accounts_problem() const { return http_ ? http_->problem() : std::string(); }

  /// One turn of the control loop; call every 20 ms or so.
  void tick();
  [[nodiscard]] const ShowStatus& status() const { return status_; }
  [[nodiscard]] const std::vector<Health>& devices() const { return devices_; }
  /// Handlers for the requests of clients.
  [[nodiscard]] HttpHandlers handlers();

  void go_safe();
  /// Any thread; bypasses the control thread. Returns when every lamp has the order and the disk has the state. Fails
  /// if a bus or the disk has not taken it; the blackout holds all the same.
  Result<void> blackout(bool on);
  /// Sends all heads that have a rest position there, dark. False if there are none.
  bool park();
  /// Ends output, with each driver's goodbye, and the page.
  void stop();

 private:
  struct Command {
    std::function<void(Time)> run;
    std::promise<void> done;
  };
  std::future<void> queue(std::function<void(Time)> run);
  /// Runs the queued commands; true if there were any.
  bool run_commands(Time at);
  void on_control_thread(std::function<void(Time)> run);
  /// Buses whose lamps do not have the order after one second, in words; empty if all have it.
  [[nodiscard]] std::string wait_until_dark(std::uint64_t order) const;
  /// Result of `run` on the control thread; nullopt if that thread does not get to it in time. The promise is shared,
  /// as the wait ends at the time limit of a command, and `run` may come later.
  template <class T>
  std::optional<T> ask_control_thread(std::function<T(Time)> run) {
    const auto answer = std::make_shared<std::promise<T>>();
    std::future<T> given = answer->get_future();
    on_control_thread([answer, run = std::move(run)](Time at) { answer->set_value(run(at)); });
    if (given.wait_for(Duration{}) != std::future_status::ready) return std::nullopt;
    return given.get();
  }
  [[nodiscard]] Result<std::string> start_job(const std::string& kind);
  Result<void> identify(const std::string& name, double seconds);
  Result<void> aim(const std::string& name, const Joints& joints, double level, double seconds);
  Result<void> park(const std::vector<std::string>& names);
  Result<std::string> hold(ByHand::What what, const std::vector<std::string>& names, double value,
                           const ByHandTimes& times);
  /// Each by its value.
  Result<std::string> hold(const std::shared_ptr<const Session>& session, std::vector<ByHand> wanted,
                           const ByHandTimes& times);
  Result<std::string> hold_levels(const std::vector<std::pair<std::string, double>>& levels, const ByHandTimes& times);
  Result<std::string> release(const std::vector<std::string>& names, std::optional<double> fade_s);
  Result<std::string> bypass(const std::vector<std::string>& names, bool on);
  void restore_bypassed(const std::vector<std::string>& saved, Resumed& resumed);
  [[nodiscard]] Checked<std::string> reload();
  void restore_by_hand(const std::vector<SavedByHand>& saved, Resumed& resumed);
  /// Levels and goals held by hand, as the journal stores them.
  [[nodiscard]] std::vector<SavedByHand> held_by_hand(const Rig& rig, Time at) const;
  void add_alarms(Time at);
  /// Fixture by name; a housing's name gives its first emitter.
  [[nodiscard]] Result<std::size_t> fixture_called(const std::string& name) const;
  [[nodiscard]] std::string universes_json();
  /// Null before the first tick.
  [[nodiscard]] std::shared_ptr<const PublishedStatus> published() const;
  /// status: must outlive the result.
  [[nodiscard]] StatusInput input_of(const PublishedStatus& status);
  void send_program();
  void publish(Time at);
  /// Claims the rig's outputs; fails if another process holds one.
  [[nodiscard]] Result<void> claim_outputs();
  void draw_room_beside();
  [[nodiscard]] OutputOrders orders();
  [[nodiscard]] std::unique_ptr<Driver> make_driver(const Rig& rig, std::size_t bus) const;
  /// Carries out a blackout that a contact asked for, without waiting for the control thread.
  void watch_contacts(const std::stop_token& stop);
  void add_contact_alarms(Time at);
  void start_guardian(Time at);
  void tell_guardian(Time at);
  void look_after_guardian(Time at);
  /// Treatment of a plan that cannot be saved. is_saved: it is on disk already.
  enum class Unsaved { is_refused, goes_on, is_saved };
  /// plan_json: text of the same plan, for the journal.
  [[nodiscard]] Checked<std::string> apply(const Plan& plan, const std::string& plan_json, bool of_rig, Unsaved unsaved,
                                           std::optional<double> fade_s = {});
  /// A plan as a client sends it.
  [[nodiscard]] Checked<std::string> apply_json(const std::string& plan_json, std::optional<double> fade_s);

  DaemonOptions options_;
  ShowController controller_;
  ProgramMailbox programs_;
  Claims folder_claim_, output_claims_;
  BlackoutSwitch blackout_;
  QuestionBoard questions_;
  LightPreview preview_;
  std::optional<LastLookMemory> guarded_;  ///< shared with the guardian
  std::counting_semaphore<> contact_pressed_{0};
  std::vector<std::optional<Time>> contact_unknown_since_, contact_pressed_since_;  ///< by bus
  std::vector<std::unique_ptr<BusThread>> buses_;
  std::unique_ptr<HttpApi> http_;
  Journal journal_;
  ChangeLog change_log_;
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

  std::mutex change_mutex_;  // one change of plan or rig at a time

  mutable std::mutex mutex_;  // guards the members from here to commands_
  std::shared_ptr<const Session> session_;
  std::shared_ptr<const Session> first_session_;  ///< drivers and buses use this rig to the end
  RigVersion version_;                            ///< of session_
  std::optional<RigVersion> plan_made_for_;       ///< of the plan in force
  Time plan_at_{};
  std::shared_ptr<RigFileWatch> rig_file_watch_;
  std::optional<Time> rig_file_changed_at_, unsaved_since_;
  RoomView room_;
  StatusChanges changes_;                             ///< guards itself
  std::shared_ptr<const PublishedStatus> published_;  ///< null before the first tick
  std::deque<Command> commands_;

  Jobs jobs_;  ///< last, with the threads below: they use the members above
  std::jthread drawing_, contacts_;
};

}  // namespace luxrig
