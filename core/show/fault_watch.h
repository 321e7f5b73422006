#pragma once
/// Faults that no device reports, found by readings that do not fit together: a lamp that went dark, a meter that is
/// covered, two that were exchanged, a lamp that was knocked (core/estimation/change_cause.h). It says what it finds,
/// with the evidence. Where several causes explain the readings, it names a lamp to dim for a moment; the show does
/// that, and which meters follow decides.

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/change_cause.h"
#include "core/estimation/gain_estimator.h"
#include "core/show/show_controller.h"
#include "core/show/usual_reading.h"

namespace luxrig {

class FaultWatch {
 public:
  /// Of its level, what a lamp keeps that is dimmed to see which meters follow; and the second time.
  static constexpr double kDippedTo = 0.8, kDippedAgainTo = 0.5;

  explicit FaultWatch(const Rig& rig);

  /// Runs a task once, on any thread. With it, causes are searched beside the loop (a quarter of a second for 200 lamps),
  /// and the next look() after that uses what was found; without it, look() waits for that.
  using Runner = std::function<void(std::function<void()>)>;
  void use(Runner runner) { runner_ = std::move(runner); }

  /// The light changes until `settled`. What meters show from then on counts, once the slowest has followed.
  void light_changes(Time settled);
  /// Every reading, believed or not.
  void hear(const LuxReading& reading);
  /// Call it under steady light, as often as you like. levels: per fixture, as they are out; of a lamp that is dimmed
  /// for us, as beside the dip.
  void look(Time now, const GainEstimator& estimator, const std::vector<double>& levels);
  /// Adds the alarm, if something is found.
  void tell(ShowStatus& status) const;
  /// All readings so far are of another light, another rig, or are taken as right.
  void forget();

  /// Readings are not as usual, and it is not known yet why: corrections should wait.
  [[nodiscard]] bool examines(Time now) const;

  struct Dip {
    std::size_t fixture = 0;
    double level_share = 1;  ///< of its level that is left
  };
  /// The lamp to dim now, so that the causes are told apart; nullopt: none, or not now. may: per fixture, 1 = it may be
  /// dimmed.
  [[nodiscard]] std::optional<Dip> lamp_to_dip(Time now, std::span<const std::uint8_t> may) const;
  /// It would be dimmed, but the rig file forbids that (`fault_dips`): what is found says so where it would tell more.
  void dip_is_barred(const Dip& dip) { barred_ = dip.fixture; }
  /// It is being dimmed. Call light_changes(), too.
  void dip_begins(const Dip& dip);
  /// Enough has been read under the dip.
  [[nodiscard]] bool dip_is_read() const;
  /// It is over. What was read counts if it is enough.
  void dip_ends();

  struct Finding {
    std::vector<ChangeCause> causes;  ///< one, or those between which the meters cannot decide
    std::string text;                 ///< with the evidence, and what to do
    Time since{};
    /// Per luxmeter: its reading over what is usual, if that is not as usual.
    std::vector<std::optional<MeanReading>> changed{};
  };
  [[nodiscard]] const std::optional<Finding>& found() const { return found_; }

 private:
  struct Heard {
    double sum_lx = 0;
    int count = 0;
    double last_lx = 0;
    Time last{};
  };
  /// Readings since the last look over what the model states, per luxmeter; none = nothing was heard, or it is dark.
  [[nodiscard]] std::vector<std::optional<double>> take_heard(const GainEstimator& estimator,
                                                              const std::vector<double>& levels);
  /// What is usual is less certain by what the model may be wrong of these changes.
  void follow_levels(const GainEstimator& estimator, const std::vector<double>& levels);
  void begin_change(Time now);
  void end_change();
  [[nodiscard]] std::vector<std::optional<MeanReading>> changed_meters() const;
  /// What was found is over: by its last reading, each meter that read otherwise is as usual again.
  [[nodiscard]] bool all_are_back(const GainEstimator& estimator, const std::vector<double>& levels) const;
  void listen(Time now, const std::vector<std::optional<double>>& ratio);
  [[nodiscard]] LightChange change(const GainEstimator& estimator, const std::vector<double>& levels) const;
  void share_out(const GainEstimator& estimator, std::size_t luxmeter, LightChange& change) const;
  [[nodiscard]] double noise_lx(std::size_t luxmeter, int samples) const;
  void ask_for_causes();
  void take_causes(Time now);
  void judge(Time now, std::vector<ChangeCause> likely);
  void add_doubt_of_lamps();
  [[nodiscard]] int meters_that_see(std::size_t fixture) const;
  [[nodiscard]] std::string words(const ChangeCause& cause) const;
  [[nodiscard]] std::string evidence() const;
  [[nodiscard]] std::string of_dips() const;
  [[nodiscard]] std::string of_barred_dip(const std::vector<ChangeCause>& causes) const;

  /// Causes that are searched, or wait to be taken up.
  struct Search {
    std::atomic<bool> done{false};
    std::vector<ChangeCause> likely{};
  };

  std::shared_ptr<const std::vector<Fixture>> fixtures_;  ///< shared with searches
  Runner runner_;
  std::shared_ptr<Search> search_;  ///< null = none
  Time judged_at_{};
  std::vector<std::string> meters_;
  std::vector<UsualReading> usual_;  ///< per luxmeter
  std::vector<double> last_levels_;
  std::vector<Heard> heard_;  ///< per luxmeter, since the last look
  Time steady_from_{}, looked_at_{};
  bool changed_ = false;  ///< some meter reads something else than usual
  Time changed_since_{};
  int quiet_ = 0;                   ///< samples in a row without a difference
  int passed_by_ = 0;               ///< changes that went by themselves
  std::vector<MeanReading> since_;  ///< per luxmeter: reading over what is usual, since the change
  LightChange change_;              ///< as of the last look before causes were asked for
  std::vector<ChangeCause> likely_, candidate_;
  int same_ = 0;                        ///< samples in a row that led to candidate_
  std::optional<Dip> dip_;              ///< now
  std::vector<MeanReading> dip_share_;  ///< per luxmeter: reading over what is usual beside it
  int dip_looks_ = 0;
  std::vector<LampDip> dips_;          ///< since the change
  std::optional<std::size_t> barred_;  ///< fixture whose dip would have told more, since the change
  std::optional<Finding> found_;
};

}  // namespace luxrig
