#include "optimize/search_samples.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

/// The samples of a pass that fall on the film, and the square of each.
struct PassSamples {
    std::vector<BatchSample> samples;
    std::vector<int> squares;
};

PassSamples samples_of(const SearchFrame& f, const SearchTile& t, std::uint32_t pass,
                       const SearchShift& shift) {
    const Film& film = f.view.scene.film;
    PassSamples all;
    for (const int square : t.squares) {
        const int x = (t.tile.x0 + square % t.tile.width) * f.plan.scale + shift[0];
        const int y = (t.tile.y0 + square / t.tile.width) * f.plan.scale + shift[1];
        if (x < 0 || y < 0 || x >= film.crop_width || y >= film.crop_height) continue;
        BatchSample s;
        s.camera = {static_cast<std::uint32_t>(y * film.crop_width + x), pass, 0};
        all.samples.push_back(s), all.squares.push_back(square);
    }
    return all;
}

/// Adds a traced pass. The records' pixels become squares. Of light that bounces the first vertex
/// counts, with what the others bring it under the textures of tracing.
void add_pass(const SearchFrame& f, const Tile& tile, const PassSamples& pass, BatchOutput& out,
              TileSamples& to) {
    const auto add = [&](int square, const Rgbf& value) {
        for (int c = 0; c < 3; ++c)
            to.constant[static_cast<std::size_t>(3 * square + c)] += value[c];
    };
    for (std::size_t i = 0; i < pass.samples.size(); ++i) {
        to.counts[static_cast<std::size_t>(pass.squares[i])] += 1;
        add(pass.squares[i], out.emitted[i]);
    }
    std::erase_if(out.direct_samples, [](const DirectSample& d) { return d.vertex > 0; });
    for (DirectSample& d : out.direct_samples) {
        const int square = pass.squares[static_cast<std::size_t>(d.sample)];
        if (!d.has_unknowns) add(square, d.value);
        d.record.pixel = static_cast<std::uint32_t>(frame_index(f, tile, square));
    }
    to.records.push_back(pack_records(out.direct_samples, tile, f.width));
    to.memory.push_back(make_record_memory(f.shaders, to.records.back()));
}

/// A candidate as a BSDF's unknown inputs read it.
std::vector<LaneValues> inputs_at(const SearchFrame& f, const RecordShader& shader,
                                  const SearchGroup& group, std::span<const float> candidate,
                                  float color) {
    std::vector<LaneValues> inputs;
    for (const UnknownInput& u : shader.unknowns) {
        const auto slot = static_cast<std::size_t>(u.slot);
        const auto member = std::find(group.members.begin(), group.members.end(), slot);
        const auto i = static_cast<std::size_t>(member - group.members.begin());
        LaneValues lanes;
        const float of_color = i == group.color ? color : 0.5f;
        lanes.fill(f.plan.colors[slot] ? of_color : candidate[i]);
        inputs.insert(inputs.end(), u.is_color ? 3 : 1, lanes);
    }
    return inputs;
}

/// Adds what a block's records bring, where that is finite.
void add_block(const RecordBlock& block, const Rgb<Packet>& value, std::vector<float>& image) {
    std::array<LaneValues, 3> lanes;
    store(lanes.data(), value);
    for (std::size_t k = 0; k < kLanes; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            if (std::isfinite(lanes[c][k]))
                image[3 * std::size_t{block.pixel[k]} + c] += lanes[c][k];
}

/// Lanes behind the last record of a run carry no light; a record does.
bool is_record(const RecordBlock& block, std::size_t lane) {
    return block.radiance_over_pdf[0][lane] != 0 || block.radiance_over_pdf[1][lane] != 0 ||
           block.radiance_over_pdf[2][lane] != 0;
}

/// The region of the texel that a group's first texture reads most of at uv.
std::uint32_t region_at(const SearchFrame& f, const SearchGroup& group, const Vec2f& uv) {
    const TextureId texture = f.plan.unknowns[group.members.front()];
    const auto& bitmap = std::get<Bitmap>((*f.view.scene.scene)[texture]);
    return group.regions.of_texel[main_texel(footprint(bitmap, uv))];
}

/// What the samples of a tile met.
struct Met {
    std::vector<std::vector<std::uint64_t>> regions;  ///< of each group: square << 32 | region
    std::vector<int> group;                           ///< of each square, -1: none
    std::vector<char> shared;  ///< non-zero: several, or a BSDF that tells nothing
};

void add_met(const SearchFrame& f, const RecordRun& run, const TileRecords& records, Met& met) {
    const int g = f.groups[static_cast<std::size_t>(run.bsdf.value)];
    const SearchGroup& group = f.plan.groups[static_cast<std::size_t>(g)];
    for (const RecordBlock& block : blocks_of(run, records))
        for (std::size_t k = 0; k < kLanes; ++k) {
            if (!is_record(block, k)) continue;
            const std::size_t square = block.pixel[k];
            if (met.group[square] >= 0 && met.group[square] != g) met.shared[square] = 1;
            met.group[square] = g;
            if (!f.tells[static_cast<std::size_t>(run.bsdf.value)]) met.shared[square] = 1;
            const std::uint32_t region = region_at(f, group, {block.u[k], block.v[k]});
            if (region != TextureRegions::kNone)
                met.regions[static_cast<std::size_t>(g)].push_back(std::uint64_t{square} << 32 |
                                                                   region);
        }
}

/// Counts equal entries; the shares of a square add up to 1.
std::vector<RegionShare> shares_of(std::vector<std::uint64_t> met,
                                   const std::vector<char>& shared) {
    std::sort(met.begin(), met.end());
    std::vector<RegionShare> shares;
    for (const std::uint64_t m : met) {
        const RegionShare one{static_cast<std::uint32_t>(m >> 32), static_cast<std::uint32_t>(m),
                              1};
        if (shared[one.square]) continue;
        if (!shares.empty() && shares.back().square == one.square &&
            shares.back().region == one.region)
            shares.back().weight += 1;
        else
            shares.push_back(one);
    }
    for (std::size_t i = 0; i < shares.size();) {
        std::size_t end = i;
        float sum = 0;
        for (; end < shares.size() && shares[end].square == shares[i].square; ++end)
            sum += shares[end].weight;
        for (; i < end; ++i) shares[i].weight /= sum;
    }
    return shares;
}

TileSamples trace_half(const SearchFrame& f, const SearchTile& t, std::size_t half) {
    const SearchPasses& passes = f.halves[half];
    TraceInput input;
    input.scene = &f.view.scene, input.textures = f.textures.get();
    input.key = passes.key, input.unknown_bsdfs = f.unknown_bsdfs, input.slots = f.slots;
    input.keep_black = true, input.sequence = Sequence::kSobol, input.mixture = f.mixture;
    TileSamples samples;
    const auto squares = static_cast<std::size_t>(t.tile.width * t.tile.height);
    samples.constant.assign(3 * squares, 0), samples.counts.assign(squares, 0);
    thread_local BatchOutput out;  // scratch memory only
    for (std::uint32_t pass = 0; pass < passes.shifts.size(); ++pass) {
        const PassSamples traced = samples_of(f, t, pass, passes.shifts[pass]);
        trace_batch(input, traced.samples, out);
        add_pass(f, t.tile, traced, out, samples);
    }
    return samples;
}

/// The picture of a half, with the colours of a group at `color`.
std::vector<float> shade_half(const SearchFrame& f, const TileSamples& samples, std::size_t group,
                              std::span<const float> candidate, float color) {
    std::vector<float> image = samples.constant;
    for (std::size_t pass = 0; pass < samples.records.size(); ++pass) {
        const TileRecords& records = samples.records[pass];
        const LaneValues* constants = samples.memory[pass].constant_inputs.data();
        for (const RecordRun& run : records.runs) {
            const auto bsdf = static_cast<std::size_t>(run.bsdf.value);
            const RecordShader& shader = f.shaders[bsdf];
            if (f.groups[bsdf] == static_cast<int>(group)) {
                const auto inputs = inputs_at(f, shader, f.plan.groups[group], candidate, color);
                const LaneValues* of_block = constants;
                for (const RecordBlock& block : blocks_of(run, records)) {
                    add_block(block, shade(shader, block, of_block, inputs.data(), nullptr), image);
                    of_block += shader.constant_inputs.size();
                }
            }
            constants += shader.constant_inputs.size() * (run.end - run.begin);
        }
    }
    for (std::size_t i = 0; i < image.size(); ++i)
        image[i] /= std::max(1.0f, samples.counts[i / 3]);
    return image;
}

std::vector<float> render_half(const SearchFrame& f, const SearchTile& t, std::size_t half,
                               const TextureTable& textures) {
    const SearchPasses& passes = f.halves[half];
    TraceInput input;
    input.scene = &f.view.scene, input.textures = &textures, input.key = passes.key;
    input.sequence = Sequence::kSobol;
    const auto squares = static_cast<std::size_t>(t.tile.width * t.tile.height);
    std::vector<float> image(3 * squares, 0.0f), counts(squares, 0.0f);
    std::vector<Rgbf> radiance;
    for (std::uint32_t pass = 0; pass < passes.shifts.size(); ++pass) {
        const PassSamples traced = samples_of(f, t, pass, passes.shifts[pass]);
        radiance.resize(traced.samples.size());
        trace_radiance(input, traced.samples, radiance);
        for (std::size_t i = 0; i < radiance.size(); ++i) {
            const auto square = static_cast<std::size_t>(traced.squares[i]);
            counts[square] += 1;
            for (int c = 0; c < 3; ++c)
                image[3 * square + static_cast<std::size_t>(c)] += radiance[i][c];
        }
    }
    for (std::size_t i = 0; i < image.size(); ++i) image[i] /= counts[i / 3];
    return image;
}

std::vector<std::vector<RegionShare>> find_shares(const SearchFrame& f, const Tile& tile,
                                                  const std::array<TileSamples, 2>& halves) {
    const std::size_t squares = halves[0].counts.size();
    Met met{std::vector<std::vector<std::uint64_t>>(f.plan.groups.size()),
            std::vector<int>(squares, -1), std::vector<char>(squares, 0)};
    for (const TileSamples& half : halves)
        for (const TileRecords& records : half.records)
            for (const RecordRun& run : records.runs) add_met(f, run, records, met);
    std::vector<std::vector<RegionShare>> shares;
    for (auto& regions : met.regions) {
        shares.push_back(shares_of(std::move(regions), met.shared));
        std::erase_if(shares.back(), [&](const RegionShare& s) {
            const std::size_t at = 3 * frame_index(f, tile, static_cast<int>(s.square));
            return halves[0].counts[s.square] == 0 || halves[1].counts[s.square] == 0 ||
                   !(f.weight[at] + f.weight[at + 1] + f.weight[at + 2] > 0);
        });
    }
    return shares;
}

}  // namespace

std::vector<SearchTile> make_search_tiles(const SearchFrame& f) {
    Film film;
    film.width = film.crop_width = f.width, film.height = film.crop_height = f.height;
    std::vector<SearchTile> tiles;
    for (const Tile& tile : make_tiles(film, kRecordTile)) {
        SearchTile t{tile, {}};
        for_pixels_in_blocks(tile, [&](int x, int y) {
            const int square = y * tile.width + x;
            if (f.seen[frame_index(f, tile, square)]) t.squares.push_back(square);
        });
        if (!t.squares.empty()) tiles.push_back(std::move(t));
    }
    return tiles;
}

std::vector<ViewTile> make_view_tiles(std::span<const SearchFrame> frames) {
    std::vector<ViewTile> tiles;
    for (const SearchFrame& f : frames)
        for (SearchTile& tile : make_search_tiles(f)) tiles.push_back({&f, std::move(tile)});
    return tiles;
}

TracedTile trace_tile(const SearchFrame& f, const SearchTile& t) {
    TracedTile traced{f, t.tile, {trace_half(f, t, 0), trace_half(f, t, 1)}, {}};
    traced.shares = find_shares(f, t.tile, traced.halves);
    return traced;
}

std::array<std::vector<float>, 2> render_tile(const SearchFrame& f, const SearchTile& t,
                                              const TextureTable& textures) {
    return {render_half(f, t, 0, textures), render_half(f, t, 1, textures)};
}

GroupPictures shade_group(const TracedTile& t, std::size_t group, std::size_t candidate) {
    const SearchGroup& g = t.frame.plan.groups[group];
    GroupPictures pictures;
    for (std::size_t h = 0; h < 2; ++h) {
        const auto at = [&](float color) {
            return shade_half(t.frame, t.halves[h], group, g.candidates[candidate], color);
        };
        pictures.black[h] = at(0);
        if (g.color) pictures.white[h] = at(1);
    }
    return pictures;
}

}  // namespace burnish
