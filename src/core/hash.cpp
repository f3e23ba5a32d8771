#include "core/hash.h"

// GCC 12 takes its own _mm512_undefined_epi32() for a variable that nobody set.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#define XXH_INLINE_ALL
#include <xxhash.h>
#pragma GCC diagnostic pop

#include <new>

namespace burnish {

namespace {

XXH3_state_t* state_of(void* state) { return static_cast<XXH3_state_t*>(state); }

}  // namespace

std::uint64_t hash_of(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

void Hasher::Free::operator()(void* state) const { XXH3_freeState(state_of(state)); }

Hasher::Hasher() : state_(XXH3_createState()) {
    if (!state_) throw std::bad_alloc();
    XXH3_64bits_reset(state_of(state_.get()));
}

void Hasher::add(const void* bytes, std::size_t size) {
    if (size > 0) XXH3_64bits_update(state_of(state_.get()), bytes, size);
}

std::uint64_t Hasher::hash() const { return XXH3_64bits_digest(state_of(state_.get())); }

}  // namespace burnish
