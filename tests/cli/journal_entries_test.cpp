// SPDX-License-Identifier: Apache-2.0
// Journals whose numbers, places or first lines were changed, with fingerprints that fit.
#include <fmt/format.h>
#include <sys/stat.h>

#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "cde/jobs/journal.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

class JournalEntries : public Cli {
 protected:
  struct Entry {
    Json line;
    std::string bytes;
  };
  /// The first line, and the entries behind it.
  struct Parts {
    std::string first;
    std::vector<Entry> entries;
  };
  static Parts parts_of(const std::string& journal) {
    Parts parts;
    std::size_t at = journal.find('\n') + 1;
    parts.first = journal.substr(0, at);
    while (at < journal.size()) {
      const std::size_t end = journal.find('\n', at) + 1;
      Entry entry{Json::parse(journal.substr(at, end - at)), {}};
      at = end;
      if (entry.line.contains("bytes")) {
        const auto size = entry.line["bytes"].get<std::size_t>();
        entry.bytes = journal.substr(at, size);
        at += size + 1;
      }
      parts.entries.push_back(std::move(entry));
    }
    return parts;
  }
  static std::string journal_of(const Parts& parts) {
    std::string journal = parts.first;
    const std::string fields = parts.first.substr(0, parts.first.rfind(",\"fingerprint\":")),
                      run = fingerprint(fields);
    for (Entry entry : parts.entries) {
      const bool chunk = entry.line.contains("bytes");
      if (chunk) {
        entry.line["bytes"] = entry.bytes.size();
        entry.line["fingerprint"] = fingerprint(
            fmt::format("{} {} {} {} {}", run, entry.line["part"].get<unsigned>(),
                        entry.line["chunk"].get<unsigned>(), entry.line["input"].get<std::string>(),
                        fingerprint(entry.bytes)));
      }
      journal += entry.line.dump() + "\n";
      if (chunk) journal += entry.bytes + "\n";
    }
    return journal;
  }
  /// Expects that both readers refuse the journal "whole" with this change of its first chunk.
  void refused_with(const Words& words, const std::string& why,
                    const std::function<void(std::string&)>& change) {
    Parts parts = parts_of(read("whole"));
    change(parts.entries.front().bytes);
    write("bad", journal_of(parts));
    const std::size_t at = read("bad").find('\n', parts.first.size()) + 1;
    const std::string text =
        fmt::format("bad, byte {}: the chunk is no result of this run: {}", at, why);
    Words resume = words;
    resume.insert(resume.end(), {"--resume", "bad"});
    for (const Words& all : {resume, Words{"merge", "bad"}}) {
      const Ran ran = cde(all);
      EXPECT_EQ(ran.status, 2) << ran.err;
      EXPECT_TRUE(has(ran.err, text));
      EXPECT_FALSE(exists("x.csv"));
    }
  }
  void make_whole(Words words) {
    words.insert(words.end(), {"--resume", "whole"});
    const Ran ran = cde(words);
    ASSERT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(journal_of(parts_of(read("whole"))), read("whole"));
    std::filesystem::remove(folder_ / "x.csv");
  }
};

TEST_F(JournalEntries, CountsOfACast_AreThoseOfTheBytes) {
  write("m.obj", kOneTriangle);
  const Words words = {"cast", "m.obj", "--grid", "8x8", "-q", "-o", "x.csv"};
  make_whole(words);
  struct stat info {};
  ASSERT_EQ(::stat((folder_ / "whole").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777u, 0600u) << "others could hold the journal's lock";
  // The head ends with the length of the model's name and the number of records.
  std::size_t name = 0;
  const auto set = [&](std::size_t back, std::uint64_t number) {
    return [&name, back, number](std::string& bytes) {
      name = bytes.find(".so") != std::string::npos ? bytes.rfind('\0', bytes.find(".so")) + 1 : 0;
      ASSERT_GT(name, 16u);
      std::memcpy(bytes.data() + name - back, &number, sizeof number);
    };
  };
  for (const std::uint64_t records : {0ull, 63ull, 4000ull, 1ull << 31, ~0ull})
    refused_with(words, "it states a name of ", set(8, records));
  for (const std::uint64_t length : {0ull, 1ull << 32, 1ull << 63, ~0ull})
    refused_with(words, fmt::format("it states a name of {} bytes", length), set(16, length));
  refused_with(words, "it has 10 bytes, its head alone has ",
               [](std::string& bytes) { bytes.resize(10); });
  refused_with(words, "it states a name of ", [](std::string& bytes) { bytes += "more"; });
  // The last record, with any word that is large.
  refused_with(words, "its record 63 has ray ", [](std::string& bytes) {
    for (std::size_t i = 1; i <= 32; ++i) bytes[bytes.size() - i] = '\x40';
  });
}

TEST_F(JournalEntries, CountsOfAQueryAndARun_AreThoseOfTheBytes) {
  write("pairs", "0 0 0 1 | 1 0 0 1\n");
  const Words query = {"query", "sphere-sphere", "pairs", "-q", "-o", "x.csv"};
  const auto replace = [](const std::string& from, const std::string& to) {
    return [=](std::string& bytes) { bytes.replace(bytes.find(from), from.size(), to); };
  };
  make_whole(query);
  refused_with(query, "it states messages of 99999 bytes; ",
               replace("\"message_bytes\":0", "\"message_bytes\":99999"));
  refused_with(query, "it has 1 totals instead of 7", [](std::string& bytes) {
    const std::size_t at = bytes.find('['), end = bytes.find(']');
    bytes.replace(at, end - at, "[1");
  });
  refused_with(query, "[json.exception", replace("{", "["));
  std::filesystem::remove(folder_ / "whole");
  write("scene.toml",
        "[card]\nlanes = 4\n[[object]]\nname = \"terrain\"\nmesh = \"terrain:3,3,1\"\n"
        "[[object]]\nname = \"rays\"\nrandom_rays = { count = 3, seed = 7 }\n"
        "motion = { kind = \"still\", position = [15, 15, 300] }\n" +
            hit_query("terrain"));
  const Words run = {"run", "scene.toml", "-q", "-o", "d"};
  make_whole(run);
  refused_with(run, "it states records of 99999 bytes; ", [](std::string& bytes) {
    const std::size_t at = bytes.find("\"sizes\":[") + 9;
    bytes.replace(at, bytes.find(']', at) - at, "99999");
  });
  refused_with(run, "1 bytes follow its records", [](std::string& bytes) { bytes += "x"; });
  refused_with(run, "a list in it is [] instead of 1 entries", [](std::string& bytes) {
    Json head = Json::parse(bytes.substr(0, bytes.find('\n')));
    head["frame"]["queries"] = Json::array();
    bytes.replace(0, bytes.find('\n'), head.dump());
  });
}

/// `query` cannot read its input again, so the journals alone say where a chunk belongs.
TEST_F(JournalEntries, ExchangedOrMissingChunks_AreNotMerged) {
  std::string pairs;
  for (int i = 0; i < 140'000; ++i) pairs += fmt::format("{} 0 0 1 | 1 0 0 1\n", i % 7);
  write("pairs", pairs);
  make_whole({"query", "sphere-sphere", "pairs", "-q", "-o", "x.csv", "--no-check"});
  const Parts whole = parts_of(read("whole"));
  ASSERT_EQ(whole.entries.size(), 4u);
  const std::string why = "cde merge: bad: the inputs of the chunks of part 0 are not those that";
  Parts bad = whole;
  std::swap(bad.entries[0].line["chunk"], bad.entries[1].line["chunk"]);
  write("bad", journal_of(bad));
  refused({"merge", "bad"}, why);
  bad = whole;
  bad.entries.erase(bad.entries.begin() + 2);
  bad.entries.back().line["chunks"] = 2;
  write("bad", journal_of(bad));
  refused({"merge", "bad"}, why);
  for (const std::size_t changed : {0, 2}) {
    bad = whole;
    bad.entries[changed].line["input"] = "0123456789abcdef";
    write("bad", journal_of(bad));
    refused({"merge", "bad"}, why);
  }
  // One digit of a line, without a new fingerprint.
  std::string journal = read("whole");
  const std::size_t at = journal.find("\"input\":\"") + 9;
  journal[at] = journal[at] == '1' ? '2' : '1';
  write("bad", journal);
  refused({"merge", "bad"}, "the chunk is damaged");
  // The chunks of a complete shard are checked.
  const Words shard = {"query",      "sphere-sphere", "pairs", "-q",       "-o",   "x.csv",
                       "--no-check", "--shard",       "1/2",   "--resume", "shard"};
  ASSERT_EQ(cde(shard).status, 0);
  std::string bytes = read("shard");
  bytes[bytes.size() - 200] ^= 1;
  write("shard", bytes);
  const Ran again = cde(shard);
  EXPECT_EQ(again.status, 2);
  EXPECT_TRUE(has(again.err,
                  "the chunk is damaged, or belongs to another run; remove the file and "
                  "run its command again"))
      << again.err;
  EXPECT_EQ(cde({"merge", "whole"}).status, 0);
}

/// Two meshes of the same size, cast with the same rays.
TEST_F(JournalEntries, ChunksOfAnotherRun_AreRefused) {
  const auto words = [](const std::string& mesh) {
    return Words{"cast", mesh, "--grid", "8x8", "-q", "-o", "x.csv"};
  };
  make_whole(words("terrain:3,3,1"));
  const std::string first = parts_of(read("whole")).first;
  std::filesystem::remove(folder_ / "whole");
  make_whole(words("terrain:3,3,2"));
  write("mixed", first + read("whole").substr(parts_of(read("whole")).first.size()));
  Words resume = words("terrain:3,3,1");
  resume.insert(resume.end(), {"--resume", "mixed"});
  for (const Words& all : {resume, Words{"merge", "mixed"}})
    refused(all, "the chunk is damaged, or belongs to another run");
}

/// A pipe gives its bytes once, and a file can change after it was read.
TEST_F(JournalEntries, AnotherSceneFromAPipe_IsRefused) {
  const auto scene = [this](const std::string& seed) {
    return fmt::format(
               "[card]\nlanes = 4\n[[object]]\nname = \"terrain\"\nmesh = \"{}\"\n[[object]]\n"
               "name = \"rays\"\nrandom_rays = {{ count = 3, seed = {} }}\n"
               "motion = {{ kind = \"still\", position = [0, 0, 3] }}\n",
               (folder_ / "m.obj").string(), seed) +
           hit_query("terrain");
  };
  write("m.obj", kOneTriangle);
  write("a.toml", scene("7"));
  write("b.toml", scene("8"));
  const std::string run = "timeout 60 \"$CDE\" run /dev/stdin -q --resume j -o ";
  const Ran first = shell("cat a.toml | " + run + "a");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(shell("cat a.toml | " + run + "again").status, 0);
  const Ran other = shell("cat b.toml | " + run + "b");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "--resume: j belongs to a run with scene ")) << other.err;
  const Ran fifo = shell(
      "mkfifo f.toml && (cat b.toml > f.toml &) && timeout 60 \"$CDE\" run f.toml -q --resume f -o "
      "d");
  EXPECT_EQ(fifo.status, 0) << fifo.err;
  write("m.obj", "v 0 0 2\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  const Ran mesh = shell("cat a.toml | " + run + "c");
  EXPECT_EQ(mesh.status, 2);
  EXPECT_TRUE(has(mesh.err, "--resume: j belongs to a run with scene ")) << mesh.err;
}

TEST_F(JournalEntries, DamagedOrOldFirstLine_IsNamed) {
  write("m.obj", kOneTriangle);
  const Words words = {"cast", "m.obj", "--grid", "8x8", "-q", "-o", "x.csv"};
  make_whole(words);
  const std::string whole = read("whole");
  const auto refuse = [&](const std::string& journal, const std::string& why) {
    write("bad", journal);
    Words resume = words;
    resume.insert(resume.end(), {"--resume", "bad"});
    refused(resume, why);
    refused({"merge", "bad"}, why);
  };
  std::string bad = whole;
  bad.replace(bad.find("x.csv"), 5, "s.csv");
  refuse(bad, "bad, byte 0: the line is damaged");
  bad = whole;
  bad[bad.find("\"fingerprint\":\"") + 15] ^= 1;
  refuse(bad, "bad, byte 0: the line is damaged");
  bad = whole;
  bad.replace(bad.find("cde.journal.3"), 13, "cde.journal.2");
  refuse(bad,
         "bad is a journal of another version of cde, \"cde.journal.2\"; this version reads "
         "cde.journal.3; remove the file and run its command again");
}

}  // namespace
}  // namespace cde::testing
