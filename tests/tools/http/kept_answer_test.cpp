// An answer that stays the same is sent once, and as gzip to who takes it.
#include "tools/http/kept_answer.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace luxrig {
namespace {

std::string header(const HttpResponse& response, const std::string& name) {
  for (const auto& [known, value] : response.headers)
    if (known == name) return value;
  return "";
}

HttpResponse asked(const KeptAnswer& kept, HttpHeaders headers) {
  HttpRequest request;
  request.headers = std::move(headers);
  return answer_with(kept, request);
}

std::string unzipped(std::string gzip) {
  z_stream stream{};
  EXPECT_EQ(::inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  std::string out(1u << 20, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(gzip.data());
  stream.avail_in = static_cast<uInt>(gzip.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(::inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  ::inflateEnd(&stream);
  return out;
}

TEST(KeptAnswer, IsGzipForWhoTakesIt) {
  const std::string body(100'000, 'x');
  const KeptAnswer kept = kept_answer("text/plain", body);
  for (const char* takes : {"gzip", "deflate, gzip;q=0.5, br", "*", "x-gzip"}) {
    const HttpResponse answer = asked(kept, {{"accept-encoding", takes}});
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(header(answer, "Content-Encoding"), "gzip") << takes;
    EXPECT_LT(answer.body.size(), body.size() / 100);
    EXPECT_TRUE(unzipped(answer.body) == body);
  }
  for (const char* takes : {"", "br", "gzip;q=0", "gzip; q=0.000", "gzipped"}) {
    const HttpResponse answer = asked(kept, {{"accept-encoding", takes}});
    EXPECT_EQ(header(answer, "Content-Encoding"), "") << takes;
    EXPECT_TRUE(answer.body == body) << takes;
  }
  EXPECT_TRUE(unzipped(kept_answer("text/plain", "").gzip).empty());
}

TEST(KeptAnswer, IsNotSentToWhoHasIt) {
  const KeptAnswer kept = kept_answer("text/plain", "one"), other = kept_answer("text/plain", "two");
  const std::string plain = header(asked(kept, {}), "ETag");
  const std::string gzip = header(asked(kept, {{"accept-encoding", "gzip"}}), "ETag");
  EXPECT_NE(plain, gzip) << "strong: other bytes";
  EXPECT_EQ(plain, header(asked(kept_answer("text/plain", "one"), {}), "ETag")) << "in every process";
  for (const std::string& has : {plain, "\"x\", " + plain, "W/" + plain, std::string("*")}) {
    const HttpResponse answer = asked(kept, {{"if-none-match", has}});
    EXPECT_EQ(answer.status, 304) << has;
    EXPECT_TRUE(answer.body.empty());
    EXPECT_EQ(header(answer, "ETag"), plain);
    EXPECT_EQ(asked(other, {{"if-none-match", has}}).status, has == "*" ? 304 : 200) << has;
  }
  for (const std::string& has : {gzip, std::string("\"x\""), std::string(), plain.substr(1)})
    EXPECT_EQ(asked(kept, {{"if-none-match", has}}).status, 200) << has;
}

}  // namespace
}  // namespace luxrig
