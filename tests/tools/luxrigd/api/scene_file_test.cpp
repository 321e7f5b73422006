#include "tools/luxrigd/api/scene_file.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "core/scene/scene_glb.h"

namespace luxrig {
namespace {

std::shared_ptr<const Session> session_with(float width_m) {
  auto session = std::make_shared<Session>();
  session->scene.vertices_m = {Vec3f(0, 0, 0), Vec3f(width_m, 0, 0), Vec3f(0, 1, 0)};
  session->scene.triangles = {{0, 1, 2}};
  session->scene.material_of_triangle = {0};
  session->scene.materials.resize(1);
  return session;
}

HttpRequest asked(const std::string& if_none_match = {}) {
  HttpRequest request{"GET", "/api/scene", "", {}, "", ""};
  if (!if_none_match.empty()) request.headers.emplace_back("if-none-match", if_none_match);
  return request;
}

std::string header(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return value;
  return "";
}

TEST(SceneFile, GivesTheFileThenOnlySaysThatItIsTheSame) {
  const auto session = session_with(2);
  SceneFile file([&] { return session; });
  const HttpResponse first = file.answer(asked());
  EXPECT_EQ(first.status, 200);
  EXPECT_EQ(first.content_type, "model/gltf-binary");
  EXPECT_EQ(first.body, scene_glb(session->scene));
  EXPECT_EQ(header(first, "Cache-Control"), "private, no-cache");
  const std::string etag = header(first, "ETag");
  ASSERT_EQ(etag.size(), 18u);
  EXPECT_EQ(etag.front(), '"');
  for (const std::string& tags : {etag, "\"x\", " + etag, "W/" + etag, std::string("*")}) {
    const HttpResponse again = file.answer(asked(tags));
    EXPECT_EQ(again.status, 304) << tags;
    EXPECT_EQ(again.body, "") << tags;
    EXPECT_EQ(header(again, "ETag"), etag) << tags;
  }
  for (const char* tags : {"\"x\"", ",", "\"\"", "W/"}) EXPECT_EQ(file.answer(asked(tags)).status, 200) << tags;
}

TEST(SceneFile, IsAnotherFileAfterAReload) {
  auto session = session_with(2);
  SceneFile file([&] { return session; });
  const std::string before = header(file.answer(asked()), "ETag");
  session = session_with(3);
  const HttpResponse after = file.answer(asked(before));
  EXPECT_EQ(after.status, 200);
  EXPECT_NE(header(after, "ETag"), before);
  EXPECT_EQ(after.body, scene_glb(session->scene));
}

TEST(SceneFile, SaysWhenThereIsNothingToShow) {
  SceneFile none([] { return std::shared_ptr<const Session>(); });
  EXPECT_EQ(none.answer(asked()).status, 404);
  SceneFile empty([] { return std::make_shared<const Session>(); });
  EXPECT_EQ(empty.answer(asked()).status, 404);
}

TEST(SceneFile, IsWholeForManyAtOnce) {
  const auto session = session_with(2);
  const std::string whole = scene_glb(session->scene);
  SceneFile file([&] { return session; });
  std::atomic<int> right{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i) clients.emplace_back([&] { right += file.answer(asked()).body == whole ? 1 : 0; });
  for (auto& client : clients) client.join();
  EXPECT_EQ(right, 8);
}

}  // namespace
}  // namespace luxrig
