// Painting over HTTP: codes, ETags and bodies.
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/tools/luxrigd/painted_room.h"
#include "tools/luxrigd/api/command_limits.h"
#include "tools/luxrigd/api/route_table.h"

namespace luxrig {
namespace {

using nlohmann::json;

std::string header_of(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return value;
  return "";
}

class PaintingRoutesTest : public testing::PaintedRoomTest {
 protected:
  void SetUp() override {
    PaintedRoomTest::SetUp();
    handlers_.painting = goals();
    routes_ = http_routes(handlers_);
  }
  HttpResponse ask(const std::string& method, const std::string& path, const std::string& body = {},
                   const HttpHeaders& headers = {}) const {
    for (const HttpRoute& route : routes_)
      if (route.method == method && path_is_of(path, route.path))
        return route.handle({method, path, "", headers, body, "somebody"});
    return {404, "", "", {}};
  }
  HttpResponse put(const std::vector<Stroke>& strokes, const std::string& if_match) const {
    return ask("PUT", "/api/surface-goals/floor", painting_to_json(strokes), {{"if-match", if_match}});
  }
  HttpHandlers handlers_;
  std::vector<HttpRoute> routes_;
};

TEST_F(PaintingRoutesTest, AStrokeIsPutAndReadBack) {
  const json all = json::parse(ask("GET", "/api/surface-goals").body);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["name"], "floor");
  EXPECT_EQ(all[0]["strokes"], 0);
  EXPECT_EQ(ask("PUT", "/api/surface-goals/floor", painting_to_json({})).status, 503);
  const std::string bare = testing::PaintedRoomTest::patches_of(*handlers_.painting);
  const std::string first = header_of(ask("GET", "/api/surface-goals/floor"), "ETag");
  const HttpResponse done = put({bucket(120)}, first);
  ASSERT_EQ(done.status, 200) << done.body;
  const json change = json::parse(done.body);
  EXPECT_EQ(change["strokes"], 1);
  ASSERT_GT(change["patches"].size(), 20u);
  EXPECT_EQ(change["lux"][0], 120);
  const HttpResponse now = ask("GET", "/api/surface-goals/floor");
  EXPECT_EQ(header_of(now, "ETag"), header_of(done, "ETag"));
  EXPECT_EQ(json::parse(now.body)["strokes"], json::parse(painting_to_json(std::vector{bucket(120)}))["strokes"]);

  const HttpResponse stale = put({}, first);
  EXPECT_EQ(stale.status, 412);
  EXPECT_EQ(json::parse(stale.body)["strokes"].size(), 1u);
  EXPECT_EQ(header_of(stale, "ETag"), header_of(done, "ETag"));
  for (const char* none : {"W/\"x\"", "x", "\"", ""}) EXPECT_EQ(put({}, none).status, 412) << none;
  EXPECT_EQ(put({}, "*").status, 200);

  EXPECT_EQ(put({bucket(50)}, header_of(ask("GET", "/api/surface-goals/floor"), "ETag")).status, 200);
  EXPECT_EQ(ask("POST", "/api/save-painting", "{}").status, 200);
  EXPECT_EQ(testing::text_of(file("floor.json")), painting_to_json(std::vector{bucket(50)}));
}

TEST_F(PaintingRoutesTest, PatchesHaveTheirPlacesAndLux) {
  (void)patches_of(*handlers_.painting);
  ASSERT_EQ(put({bucket(120)}, "*").status, 200);
  const HttpResponse answer = ask("GET", "/api/surface-patches/floor");
  ASSERT_EQ(answer.status, 200);
  const std::string& bytes = answer.body;
  std::uint32_t count = 0;
  double cell_m = 0, origin_m[3] = {};
  std::memcpy(&count, bytes.data() + 4, 4);
  std::memcpy(&cell_m, bytes.data() + 8, 8);
  std::memcpy(origin_m, bytes.data() + 16, 24);
  EXPECT_EQ(bytes.substr(0, 4), "LXP1");
  EXPECT_EQ(cell_m, 0.2);
  EXPECT_EQ("\"" + bytes.substr(40, 16) + "\"", header_of(ask("GET", "/api/surface-goals/floor"), "ETag"));
  ASSERT_EQ(bytes.size(), 64 + 20 * std::size_t{count});
  std::size_t painted = 0;
  for (std::uint32_t p = 0; p < count; ++p) {
    float lux = 0, at_m[3] = {};
    std::memcpy(&lux, bytes.data() + 64 + 16 * std::size_t{count} + 4 * std::size_t{p}, 4);
    std::memcpy(at_m, bytes.data() + 64 + 16 * std::size_t{p}, 12);
    if (std::isnan(lux)) continue;
    ++painted;
    EXPECT_EQ(lux, 120);
    EXPECT_NEAR(at_m[2] + origin_m[2], session_->rays->bounds_world_m().min().z(), 1e-6);
    EXPECT_EQ(bytes[64 + 16 * std::size_t{p} + 14], 127) << "up";
  }
  EXPECT_GT(painted, 20u);
  EXPECT_EQ(ask("GET", "/api/surface-patches/floor", "", {{"if-none-match", header_of(answer, "ETag")}}).status, 304);
}

TEST_F(PaintingRoutesTest, HostileRequestsAreRefusedWithAReason) {
  (void)patches_of(*handlers_.painting);
  const std::string version = handlers_.painting->document("floor")->version;
  const auto with = [&](const std::string& stroke) {
    return ask("PUT", "/api/surface-goals/floor", R"({"luxrig_painting":1,"strokes":[)" + stroke + "]}").status;
  };
  const std::string there = R"("path":[{"position":[1,1,0],"normal":[0,0,1]}])";
  for (const std::string& stroke : std::initializer_list<std::string>{
           std::string(R"({"kind":"bucket","lux":NaN,)") + there + "}",
           R"({"kind":"bucket","lux":1e999,)" + there + "}", R"({"kind":"bucket","lux":-1,)" + there + "}",
           R"({"kind":"bucket",)" + there + "}", R"({"kind":"flood","lux":1,)" + there + "}",
           R"({"kind":"bucket","lux":1,"path":[]})",
           R"({"kind":"bucket","lux":1,"path":[{"position":[1,1,0],"normal":[0,0,0]}]})",
           R"({"kind":"bucket","lux":1,"path":[{"position":[9e9,1,0],"normal":[0,0,1]}]})",
           R"({"kind":"brush","lux":1,"radius_m":-1,"falloff":0,)" + there + "}", std::string("[]"), std::string("{")})
    EXPECT_EQ(with(stroke), 400) << stroke;
  for (const char* body : {"", "null", "[]", "{}", R"({"luxrig_painting":2,"strokes":[]})"})
    EXPECT_EQ(ask("PUT", "/api/surface-goals/floor", body).status, 400) << body;
  EXPECT_EQ(ask("PUT", "/api/surface-goals/flor", painting_to_json({})).status, 404);
  EXPECT_EQ(ask("PUT", "/api/surface-goals/%zz", painting_to_json({})).status, 404);
  EXPECT_EQ(ask("GET", "/api/surface-goals/..%2f..%2fetc").status, 404);
  EXPECT_EQ(ask("GET", "/api/surface-patches/flor").status, 404);
  for (const char* body : {"", "[]", R"({"goals":"floor"})", R"({"goals":[1]})"})
    EXPECT_EQ(ask("POST", "/api/save-painting", body).status, 400) << body;
  for (const char* body :
       {"{}", R"({"name":""})", R"({"name":"a\nb"})", R"({"name":"a","max_lux":-1})", R"({"name":1})"})
    EXPECT_EQ(ask("POST", "/api/surface-goals", body).status, 400) << body;
  EXPECT_EQ(ask("POST", "/api/surface-goals", R"({"name":"floor"})").status, 409);
  EXPECT_EQ(handlers_.painting->document("floor")->version, version);
}

TEST_F(PaintingRoutesTest, ANameIsPercentEncodedInThePath) {
  EXPECT_EQ(ask("POST", "/api/surface-goals", R"({"name":"Wand 1/2+ ö"})").status, 200);
  const HttpResponse found = ask("GET", "/api/surface-goals/Wand%201%2F2+%20%C3%B6");
  EXPECT_EQ(found.status, 200);
  EXPECT_EQ(json::parse(found.body)["name"], "Wand 1/2+ ö");
}

TEST(PaintingRoutes, BodiesAreBoundedAndANewGoalIsForThoseWhoConfigure) {
  for (const ApiRoute& route : route_table()) {
    const std::string path = route.path, method = route.method;
    if (method == "PUT" && path == "/api/surface-goals/{name}") {
      EXPECT_EQ(route.max_body_bytes, kMaxPaintingBytes);  // far below 10⁶ places
      EXPECT_EQ(route.role, Role::operate);
    }
    if (method == "POST" && path == "/api/surface-goals") {
      EXPECT_EQ(route.role, Role::configure);
    }
  }
}

}  // namespace
}  // namespace luxrig
