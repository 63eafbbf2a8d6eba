// SPDX-License-Identifier: Apache-2.0
// Rank 0 distributes the work. Each rank holds a second chunk while it works on one, so that it
// does not wait for rank 0 between chunks.
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <list>
#include <mutex>
#include <thread>

#include "cde/jobs/mpi_ranks.hpp"
#include "cde/support/error.hpp"
#include "jobs/mpi_requests.hpp"

namespace cde::mpi {
namespace {

enum Tag { kChunk = 1, kResult, kFailure, kEnd };
constexpr unsigned kInFlight = 2;  ///< chunks per rank without a result yet
constexpr std::size_t kLongest = (1u << 31) - 64;

struct Failure {
  ErrorCode code;
  std::string message;
};

std::string message_of(std::uint64_t number, const std::string& bytes) {
  if (bytes.size() > kLongest)
    throw Error(ErrorCode::kCapacity,
                fmt::format("chunk {} or its result has {} bytes, and MPI takes {} at once", number,
                            bytes.size(), kLongest));
  std::string message;
  message.reserve(8 + bytes.size());
  put_number(message, number);
  return message += bytes;
}
Chunk chunk_of(const std::string& message) {
  return {take_number<std::uint64_t>(message, 0), message.substr(8), std::nullopt};
}
Failure failure_of(const std::string& message) {
  return {static_cast<ErrorCode>(take_number<int>(message, 0)), message.substr(sizeof(int))};
}

/// The failure that `work` throws, if any.
template <class F>
std::optional<Failure> failure_in(const F& work) {
  try {
    work();
  } catch (const Error& e) {
    return Failure{e.code(), e.what()};
  } catch (const std::exception& e) {
    return Failure{ErrorCode::kDevice, e.what()};
  }
  return std::nullopt;
}

struct Message {
  int from = 0, tag = 0;
  std::string bytes;
};
/// A message that has arrived, if any.
std::optional<Message> receive(int from) {
  int is_there = 0, size = 0;
  MPI_Status status;
  MPI_Iprobe(from, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
  if (is_there == 0) return std::nullopt;
  MPI_Get_count(&status, MPI_BYTE, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG,
                  std::string(static_cast<std::size_t>(size), 0)};
  MPI_Request request;
  MPI_Irecv(message.bytes.data(), size, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD,
            &request);
  finish(request);
  return message;
}

void answer(const std::string& bytes, Tag tag) {
  MPI_Request request;
  MPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, tag, MPI_COMM_WORLD,
            &request);
  finish(request);
}

/// Runs a rank other than 0: works until rank 0 ends it.
void obey(const Work& work) {
  Patience patience;
  bool failed = false;
  for (;;) {
    const auto message = receive(0);
    if (!message) {
      patience.wait();
      continue;
    }
    patience.reset();
    if (message->tag == kEnd) {
      answer({}, kEnd);
      if (!message->bytes.empty()) throw Error(ErrorCode::kConfiguration, message->bytes);
      return;
    }
    if (failed) continue;
    std::string result;
    const auto failure = failure_in([&] {
      const Chunk chunk = chunk_of(message->bytes);
      result = message_of(chunk.number, work.run(chunk));
    });
    if (failure) {
      failed = true;
      result.clear();
      put_number(result, static_cast<int>(failure->code));
      result += failure->message;
    }
    answer(result, failure ? kFailure : kResult);
  }
}

/// Runs rank 0. The distributor is a thread of its own, and only that thread calls MPI meanwhile.
class Distributor {
 public:
  Distributor(const Ranks& ranks, const Work& work)
      : ranks_(ranks), work_(work), in_flight_(ranks.size(), 0), held_(ranks.size()) {}

  void run() {
    std::thread distributor([this] {
      const auto failure = failure_in([&] {
        try {
          distribute();
        } catch (...) {
          thrown_ = std::current_exception();
          throw;
        }
      });
      end_all(failure ? "the run ended on rank 0: " + failure->message : "");
    });
    labour();
    distributor.join();
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  /// Works on this rank's own share.
  void labour() {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return over_ || !mine_.empty(); });
      if (over_) return;
      const Chunk chunk = std::move(mine_.front());
      mine_.pop_front();
      lock.unlock();
      std::string result;
      auto failure = failure_in([&] { result = work_.run(chunk); });
      lock.lock();
      if (failure) {
        failure->message = ranks_.size() == 1 ? failure->message : named(0, failure->message);
        own_failure_ = std::move(failure);
      } else {
        mine_done_.push_back({chunk.number, std::move(result), std::nullopt});
      }
    }
  }

  void distribute() {
    Patience patience;
    while (in_flight_total_ + held_count_ > 0 || work_.more()) {
      const bool something = take_own() | take_message() | hand_out();
      forget_sent();
      if (something)
        patience.reset();
      else
        patience.wait();
    }
  }

  [[nodiscard]] std::string named(unsigned rank, const std::string& message) const {
    return ranks_.place(rank) + ": " + message;
  }

  void done(unsigned rank, Chunk chunk) {
    --in_flight_[rank];
    --in_flight_total_;
    work_.done(chunk.number, std::move(chunk.input));
  }
  bool take_own() {
    std::unique_lock lock(mutex_);
    if (own_failure_) throw Error(own_failure_->code, own_failure_->message);
    if (mine_done_.empty()) return false;
    Chunk chunk = std::move(mine_done_.front());
    mine_done_.pop_front();
    lock.unlock();
    done(0, std::move(chunk));
    return true;
  }
  bool take_message() {
    if (ranks_.size() == 1) return false;
    const auto message = receive(MPI_ANY_SOURCE);
    if (!message) return false;
    const auto from = static_cast<unsigned>(message->from);
    if (message->tag == kFailure) {
      const Failure failure = failure_of(message->bytes);
      throw Error(failure.code, named(from, failure.message));
    }
    done(from, chunk_of(message->bytes));
    return true;
  }

  /// Gives a chunk to the rank that it belongs to, or to the rank with the fewest chunks.
  bool hand_out() {
    for (unsigned rank = 0; rank < ranks_.size(); ++rank) {
      if (in_flight_[rank] >= kInFlight || held_[rank].empty()) continue;
      give(rank, std::move(held_[rank].front()));
      held_[rank].pop_front();
      --held_count_;
      return true;
    }
    const auto rank = static_cast<unsigned>(std::min_element(in_flight_.begin(), in_flight_.end()) -
                                            in_flight_.begin());
    if (in_flight_[rank] >= kInFlight || held_count_ >= kInFlight * ranks_.size()) return false;
    std::optional<Chunk> chunk = work_.next();
    if (!chunk) return false;
    if (!chunk->rank) {
      give(rank, std::move(*chunk));
    } else {
      ++held_count_;
      held_[*chunk->rank].push_back(std::move(*chunk));
    }
    return true;
  }
  void give(unsigned rank, Chunk chunk) {
    ++in_flight_[rank];
    ++in_flight_total_;
    if (rank == 0) {
      const std::lock_guard lock(mutex_);
      mine_.push_back(std::move(chunk));
      changed_.notify_one();
    } else {
      send(rank, kChunk, message_of(chunk.number, chunk.input));
    }
  }

  void send(unsigned rank, Tag tag, std::string bytes) {
    auto& [request, text] = sent_.emplace_back();
    text = std::move(bytes);
    MPI_Isend(text.data(), static_cast<int>(text.size()), MPI_BYTE, static_cast<int>(rank), tag,
              MPI_COMM_WORLD, &request);
  }
  void forget_sent() {
    std::erase_if(sent_, [](Sent& one) {
      int done = 0;
      MPI_Test(&one.request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
  }

  /// Ends all ranks. Receives and drops results that are still on their way.
  void end_all(const std::string& why) {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
      changed_.notify_one();
    }
    for (unsigned rank = 1; rank < ranks_.size(); ++rank) send(rank, kEnd, why);
    Patience patience;
    for (unsigned ended = 1; ended < ranks_.size() || !sent_.empty(); patience.wait()) {
      if (const auto message = receive(MPI_ANY_SOURCE)) ended += message->tag == kEnd ? 1 : 0;
      forget_sent();
    }
  }

  struct Sent {
    MPI_Request request = MPI_REQUEST_NULL;
    std::string text;
  };

  const Ranks& ranks_;
  const Work& work_;
  std::vector<unsigned> in_flight_;    ///< by rank
  std::uint64_t in_flight_total_ = 0;  ///< sum of in_flight_
  std::vector<std::deque<Chunk>>
      held_;  ///< by rank: chunks that belong to the rank and wait for it
  std::uint64_t held_count_ = 0;
  std::list<Sent> sent_;
  std::exception_ptr thrown_;  ///< by the distributor; read after it ends

  std::mutex mutex_;  ///< guards everything below
  std::condition_variable changed_;
  bool over_ = false;
  std::deque<Chunk> mine_, mine_done_;  ///< in mine_done_, `input` holds the result
  std::optional<Failure> own_failure_;
};

}  // namespace

void Ranks::distribute(const Work& work) const {
  if (rank_ != 0) return obey(work);
  Distributor(*this, work).run();
}

}  // namespace cde::mpi
