#pragma once
/// GET /api/scene: the geometry of the rig in force, as one file (core/scene/scene_glb.h).

#include <functional>
#include <memory>
#include <mutex>

#include "core/tasks/session.h"
#include "tools/http/kept_answer.h"

namespace luxrig {

class SceneFile {
 public:
  using SessionInForce = std::function<std::shared_ptr<const Session>()>;
  /// `session` is called at each request, on the server's threads.
  explicit SceneFile(SessionInForce session);
  ~SceneFile();

  /// 200 with the file and a strong ETag, 304 if the client has it (If-None-Match), 404 without a scene, 413 if it is
  /// too large to send. The file is made at the first request, once for each session, on the caller's thread: one of
  /// the server's, which have low priority. May be called from any thread.
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);

 private:
  [[nodiscard]] std::shared_ptr<const KeptAnswer> made_for(const std::shared_ptr<const Session>& session);
  SessionInForce session_;
  std::mutex mutex_;
  std::weak_ptr<const Session> of_;
  std::shared_ptr<const KeptAnswer> made_;
};

}  // namespace luxrig
