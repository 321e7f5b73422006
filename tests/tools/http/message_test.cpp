#include "tools/http/message.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tools/http/json_body.h"

namespace luxrig {
namespace {

TEST(HttpMessage, ParametersAreDecoded) {
  HttpRequest request;
  request.query = "a=1&camera=a%20b%2F+c&bad=%4&empty=&last";
  EXPECT_EQ(request.parameter("a"), "1");
  EXPECT_EQ(request.parameter("camera"), "a b/ c");
  EXPECT_EQ(request.parameter("bad"), std::nullopt);
  EXPECT_EQ(request.parameter("empty"), "");
  EXPECT_EQ(request.parameter("last"), "");
  EXPECT_EQ(request.parameter("none"), std::nullopt);
}

TEST(HttpMessage, StaticFilesComeOnlyFromTheirFolder) {
  std::string name = (std::filesystem::temp_directory_path() / "luxrig-static-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  std::filesystem::create_directories(folder / "web" / "assets");
  std::ofstream(folder / "secret.txt") << "secret";
  std::ofstream(folder / "web" / ".hidden") << "secret";
  std::ofstream(folder / "web" / "index.html") << "<p>page";
  std::ofstream(folder / "web" / "assets" / "a-1_2.js") << "1";
  const std::string web = (folder / "web").string();
  EXPECT_EQ(static_file(web, "/").body, "<p>page");
  EXPECT_EQ(static_file(web, "/").content_type, "text/html; charset=utf-8");
  EXPECT_EQ(static_file(web, "/assets/a-1_2.js").content_type, "text/javascript");
  for (const char* path : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/assets", "/none",
                           "/.hidden", "//etc/passwd/../../secret.txt", "", "secret.txt", "/..", "/assets\\..\\x"}) {
    EXPECT_EQ(static_file(web, path).status, 404) << path;
  }
  EXPECT_EQ(static_file("/nonexistent", "/").status, 404);
  std::filesystem::remove_all(folder);
}

TEST(JsonBody, IsReadUpToALimitedDepth) {
  EXPECT_EQ(json_body(R"({"a":[1,{"b":"]]]]"}]})")["a"][0], 1);
  EXPECT_TRUE(json_body(std::string(16, '[') + std::string(16, ']')).is_array());
  EXPECT_TRUE(json_body(std::string(17, '[') + std::string(17, ']')).is_discarded());
  EXPECT_TRUE(json_body("{").is_discarded());
  EXPECT_EQ(json_body('"' + std::string(100, '[') + "\\\"" + '"').get<std::string>().size(), 101u);
}

TEST(HttpMessage, ARouteWithANameInBracesHasPathsWithOneMorePart) {
  EXPECT_TRUE(path_is_of("/api/jobs", "/api/jobs"));
  EXPECT_FALSE(path_is_of("/api/jobs/", "/api/jobs"));
  for (const char* path : {"/api/jobs/7", "/api/jobs/{id}", "/api/jobs/.."})
    EXPECT_TRUE(path_is_of(path, "/api/jobs/{id}")) << path;
  for (const char* path : {"/api/jobs", "/api/jobs/", "/api/jobs/7/8", "/api/jobs/7/", "/api/job/7", "/", ""})
    EXPECT_FALSE(path_is_of(path, "/api/jobs/{id}")) << path;
  EXPECT_EQ(last_part("/api/jobs/7"), "7");
  EXPECT_EQ(last_part("7"), "7");
}

}  // namespace
}  // namespace luxrig
