#pragma once
/// The rig's surface goals as clients paint them: a list of strokes each, what follows from it, and the files beside the
/// rig file. Nothing is worked out until a client asks; a thread of low priority does it, and forgets it when nobody has
/// asked for ten minutes.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/tasks/session.h"
#include "core/tasks/surface_goals.h"
#include "tools/http/kept_answer.h"

namespace luxrig {

/// The strokes of a goal, and what tells this list from any other.
struct PaintingDocument {
  std::string version;
  std::vector<Stroke> strokes;
  bool saved = true;  ///< it is what the goal's file has
};

struct PaintingRefusal {
  enum class Why {
    unknown,   ///< there is no such goal
    not_yet,   ///< surfaces are being cut into patches: ask again in a second
    stale,     ///< the goal has other strokes than the client thinks
    invalid,   ///< what is asked for
    conflict,  ///< the rig's files are not as they were read
    disk
  };
  Why why = Why::invalid;
  std::string text;                         ///< for a person
  std::optional<PaintingDocument> present;  ///< of stale
};
template <class T>
using Painted = tl::expected<T, PaintingRefusal>;

/// What a new list of strokes changed.
struct PaintingChange {
  std::string version;
  std::size_t strokes = 0;
  std::vector<std::uint32_t> patches;  ///< rising
  std::vector<float> lux;              ///< of each; NaN = no longer painted
};

/// All functions may be called from any thread.
class PaintedGoals {
 public:
  using SessionInForce = std::function<std::shared_ptr<const Session>()>;
  /// `session` is called by the functions below, on their caller's thread.
  explicit PaintedGoals(SessionInForce session);
  ~PaintedGoals();

  struct Listed {
    SurfaceGoalSpec goal;
    PaintingDocument painting;
    bool in_force = true;  ///< false: it is in the rig file, which has not been read again since
    std::string trouble;   ///< its file cannot be read, and why
  };
  [[nodiscard]] std::vector<Listed> all();
  [[nodiscard]] Painted<PaintingDocument> document(const std::string& name);

  /// Makes this the goal's list of strokes, in memory. Only what differs is worked out again. The same list twice is no
  /// second change. if_match: refused if the goal has another version; none = whatever it has.
  [[nodiscard]] Painted<PaintingChange> put(const std::string& name, const std::vector<Stroke>& strokes,
                                            const std::optional<std::string>& if_match);

  /// All patches of a goal's surfaces with their lux, as patch_file.h has them.
  [[nodiscard]] Painted<std::shared_ptr<const KeptAnswer>> patches(const std::string& name);

  /// Writes strokes and points of these goals beside the rig file, if they are not there; empty = of all. Refused, with
  /// the files as they were, if the rig could not be read with them. How many goals were written.
  [[nodiscard]] Painted<std::size_t> save(const std::vector<std::string>& names);

  /// A new surface goal at the end of the rig file, without strokes. It is in force after a reload.
  [[nodiscard]] Painted<void> add(const std::string& name, const std::optional<double>& max_lx);

 private:
  struct Surfaces;
  struct Goal;
  Goal* find(const std::string& name);
  [[nodiscard]] tl::unexpected<PaintingRefusal> unknown(const std::string& name) const;
  /// Takes the session in force, and strokes from files that changed.
  void refresh();
  static void read_strokes(Goal& goal);
  /// Refuses while the goal's painting is not there, and has it made.
  [[nodiscard]] Painted<void> need_painting(Goal& goal);
  [[nodiscard]] static std::vector<std::uint32_t> set_strokes(Goal& goal, const std::vector<Stroke>& strokes);
  [[nodiscard]] Painted<void> save(Goal& goal);
  void make_all(const std::stop_token& stop);

  SessionInForce session_in_force_;
  std::mutex mutex_;  ///< guards what follows
  std::shared_ptr<Surfaces> surfaces_;
  std::vector<std::unique_ptr<Goal>> goals_;
  std::deque<std::string> wanted_;
  std::condition_variable_any wake_;
  std::chrono::steady_clock::time_point asked_at_{};
  bool making_ = false;
  std::jthread maker_;
};

}  // namespace luxrig
