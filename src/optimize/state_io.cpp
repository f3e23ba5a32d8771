// States as values, and as bytes: a header, then the fields of state_fields.h.
#include <cstring>

#include "core/hash.h"
#include "optimize/state_fields.h"

namespace burnish {

State::State() : values_(std::make_unique<Values>()) {}
State::State(Values values) : values_(std::make_unique<Values>(std::move(values))) {}
State::State(const State& other) : values_(std::make_unique<Values>(*other.values_)) {}
State::State(State&&) noexcept = default;
State& State::operator=(State other) {
    values_ = std::move(other.values_);
    return *this;
}
State::~State() = default;
bool operator==(const State& a, const State& b) { return *a.values_ == *b.values_; }

namespace {

constexpr char kStateMagic[8] = {'B', 'U', 'R', 'N', 'I', 'S', 'H', 'S'};

}  // namespace

std::string save_state(const State& state) {
    std::string payload, bytes;
    ArchiveWriter(sink_into(payload))(state.values());
    ArchiveWriter writer(sink_into(bytes));
    for (const char c : kStateMagic) writer(c);
    writer(kStateVersion, std::uint64_t{payload.size()}, hash_of(payload));
    return bytes + payload;
}

State load_state(const std::string& bytes) {
    ArchiveReader reader("the state", bytes.size(), source_of(bytes));
    char magic[8] = {};
    for (char& c : magic) reader(c);
    if (std::memcmp(magic, kStateMagic, sizeof magic) != 0) reader.fail("other bytes", "a state");
    std::uint32_t version = 0;
    reader(version);
    if (version != kStateVersion)
        reader.fail("version " + std::to_string(version),
                    "version " + std::to_string(kStateVersion));
    std::uint64_t size = 0, hash = 0;
    reader(size, hash);
    if (size != reader.left())
        reader.fail(std::to_string(reader.left()) + " bytes more", std::to_string(size));
    if (hash != hash_of(std::string_view(bytes).substr(bytes.size() - size)))
        reader.fail("damaged fields", "those of the hash before them");
    State::Values values;
    reader(values);
    reader.require_end();
    return State(std::move(values));
}

}  // namespace burnish
