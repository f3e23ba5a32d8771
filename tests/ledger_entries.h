// Every statistical test of the suite. To add one: an entry here and in kLedger, and its row in
// docs/testing.md (`build/release/tests/ledger table`).
#pragma once

#include "ledger.h"

namespace burnish::test::ledger {

inline constexpr LedgerEntry kGoodnessOfFit{
    .name = "core/statistics: goodness of fit",
    .catches = "a chi-square test that rejects a fair die or accepts a loaded one",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 1,
    .tests = "Statistics.GoodnessOfFitToldApart",
    .defects = {{{"a face loaded by 5 %", "Statistics.GoodnessOfFitToldApart"}}}};

inline constexpr LedgerEntry kSkewedMeans{
    .name = "core/statistics: skewed means",
    .catches = "a test of means that raises alarms where few large numbers make up a mean",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 2,
    .tests = "Statistics.MeansOfSkewedNumbersRaiseNoAlarm",
    .defects = {{{"t without its correction", "Statistics.MeansOfSkewedNumbersRaiseNoAlarm"}}}};

inline constexpr LedgerEntry kAliasTable{
    .name = "core/alias_table",
    .catches = "wrong frequencies of a discrete distribution, a remainder that is not uniform",
    .alpha = 3e-6,
    .comparisons = 3,
    .seed = 4000,
    .tests = "AliasTable.DrawsInProportionToTheWeights|AliasTable.RemainderIsUniform",
    .defects = {{{"a column without its alias", "AliasTable.DrawsInProportionToTheWeights"}}}};

inline constexpr LedgerEntry kSobol{
    .name = "core/sobol",
    .catches =
        "scrambled numbers that are not uniform over the seeds, or depend on each other within a "
        "point, between techniques, pixels or halves",
    .alpha = 1e-7,
    .comparisons = 5,
    .seed = 16000,
    .tests = "Sobol.NumbersAreIndependentOverTheSeeds",
    .defects = {
        {{"one seed for all dimensions", "Sobol.NumbersAreIndependentOverTheSeeds"},
         {"one stream for both halves", "Sobol.NumbersAreIndependentOverTheSeeds"},
         {"seed multiplied in place of added", "Sobol.NumbersAreIndependentOverTheSeeds"}}}};

inline constexpr LedgerEntry kEnvironmentWeights{
    .name = "shading/environment: weights",
    .catches = "directions of a sky that do not follow radiance times solid angle",
    .alpha = 2e-6,
    .comparisons = 3,
    .seed = 9,
    .tests = "Environment.SamplesFollowTheWeights",
    .defects = {{{"weights without the solid angle", "Environment.SamplesFollowTheWeights"}}}};

inline constexpr LedgerEntry kEnvironmentIntegral{
    .name = "shading/environment: integral",
    .catches = "a density of the sky that is not the one of the sample",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 10,
    .tests = "Environment.EstimatesAKnownIntegral",
    .defects = {{{"density 1 % too high", "Environment.EstimatesAKnownIntegral"}}}};

inline constexpr LedgerEntry kRandomEnvironment{
    .name = "shading/environment: random maps",
    .catches =
        "a sample of the sky that does not follow the density of look-ups: any size, turned, "
        "mirrored, black rows, one texel that outshines all",
    .alpha = 1e-7,
    .comparisons = 24,
    .seed = 17000,
    .tests = "Environment.SamplesOfAnyMapFollowTheDensityOfLookups",
    .defects = {
        {{"rotation inverted", "Environment.SamplesOfAnyMapFollowTheDensityOfLookups"},
         {"turned by half a texel", "Environment.SamplesOfAnyMapFollowTheDensityOfLookups"}}}};

inline constexpr LedgerEntry kPrincipledSampling{
    .name = "shading/sampling: principled",
    .catches = "a sampler that does not follow its density: lobes, sides, grazing, transmission",
    .alpha = 4e-6,
    .comparisons = 26,
    .seed = 100,
    .tests = "Sampling.PrincipledFollowsItsDensity",
    .defects = {{{"density times 1.03", "Sampling.PrincipledRejectsDefects"},
                 {"roughness 5 % larger", "Sampling.PrincipledRejectsDefects"},
                 {"alpha_x and alpha_y exchanged", "Sampling.PrincipledRejectsDefects"}}}};

inline constexpr LedgerEntry kPrincipledFloatSampling{
    .name = "shading/sampling: principled in single precision",
    .catches = "the same after rounding to the precision of rendering",
    .alpha = 2e-6,
    .comparisons = 25,
    .seed = 1000,
    .tests = "Sampling.PrincipledInFloatFollowsTheDensity",
    .defects = {
        {{"lobes chosen for another metallic", "Sampling.PrincipledInFloatFollowsTheDensity"}}}};

inline constexpr LedgerEntry kRandomSampling{
    .name = "shading/sampling: random configurations",
    .catches =
        "a sampler that fails somewhere between the chosen materials: any side, grazing, alpha "
        "from 0.001",
    .alpha = 3e-6,
    .comparisons = 24,
    .seed = 11000,
    .thorough = 2,
    .tests = "Sampling.PrincipledOfAnyConfigurationFollowsItsDensity",
    .defects = {{{"density of the reversed pair",
                  "Sampling.PrincipledOfAnyConfigurationFollowsItsDensity"}}}};

inline constexpr LedgerEntry kGrazingGlass{
    .name = "shading/sampling: grazing glass",
    .catches =
        "a sampler of rough glass that fails at 85 to 89.5 degrees, from outside or from inside",
    .alpha = 1e-7,
    .comparisons = 24,
    .seed = 18500,
    .thorough = 2,
    .tests = "Sampling.GlassAtGrazingAnglesFollowsItsDensity",
    .defects = {{{"roughness 10 % smaller", "Sampling.GlassAtGrazingAnglesFollowsItsDensity"},
                 {"1 / eta in the Jacobian of refraction",
                  "Sampling.GlassAtGrazingAnglesFollowsItsDensity"}}}};

inline constexpr LedgerEntry kDiffuseSampling{
    .name = "shading/sampling: diffuse",
    .catches = "a hemisphere that is not sampled by the cosine",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 3000,
    .tests = "Sampling.DiffuseFollowsItsDensity",
    .defects = {{{"density without its cosine", "Sampling.DiffuseFollowsItsDensity"}}}};

inline constexpr LedgerEntry kFacetSampling{
    .name = "shading/sampling: facet normals",
    .catches = "GGX and GTR1 normals that do not follow their densities, alpha from 0.0025",
    .alpha = 2e-6,
    .comparisons = 19,
    .seed = 4000,
    .tests = "Sampling.FacetNormalsFollowTheirDensities",
    .defects = {
        {{"all normals in place of the visible", "Sampling.FacetNormalsFollowTheirDensities"},
         {"alpha of GTR1 20 % larger", "Sampling.FacetNormalsFollowTheirDensities"}}}};

inline constexpr LedgerEntry kRandomFacetSampling{
    .name = "shading/sampling: facet normals of random configurations",
    .catches =
        "the same for any roughness and anisotropy of a material, any side, grazing, alpha from "
        "0.001",
    .alpha = 1e-7,
    .comparisons = 32,
    .seed = 18000,
    .thorough = 2,
    .tests = "Sampling.FacetNormalsOfAnyConfigurationFollowTheirDensities",
    .defects = {{{"alpha of GGX 10 % larger",
                  "Sampling.FacetNormalsOfAnyConfigurationFollowTheirDensities"},
                 {"alpha_x and alpha_y exchanged",
                  "Sampling.FacetNormalsOfAnyConfigurationFollowTheirDensities"},
                 {"alpha of GTR1 20 % larger",
                  "Sampling.FacetNormalsOfAnyConfigurationFollowTheirDensities"}}}};

inline constexpr LedgerEntry kInterfaceSampling{
    .name = "shading/sampling: interfaces",
    .catches = "a sampler of a conductor, plastic or dielectric that does not follow its density",
    .alpha = 1e-7,
    .comparisons = 24,
    .seed = 90000,
    .tests = "InterfaceSampling.FollowsItsDensity",
    .defects = {{{"density times 1.03", "InterfaceSampling.FollowsItsDensity"},
                 {"density of another direction", "InterfaceSampling.FollowsItsDensity"}}}};

inline constexpr LedgerEntry kInterfaceEnergy{
    .name = "shading/energy: interfaces",
    .catches = "a conductor, plastic or dielectric that sends on more than arrives",
    .alpha = 1e-7,
    .comparisons = 21,
    .seed = 91000,
    .tests = "InterfaceSampling.NoMoreLeavesThanArrives",
    .defects = {{{"a tenth more leaves", "InterfaceSampling.NoMoreLeavesThanArrives"},
                 {"radiance taken for energy", "InterfaceSampling.NoMoreLeavesThanArrives"}}}};

inline constexpr LedgerEntry kFurnace{
    .name = "shading/furnace",
    .catches = "glass or metal that sends on more than arrives, or loses light when smooth",
    .alpha = 2e-6,
    .comparisons = 42,
    .seed = 13000,
    .tests = "Furnace.NoMoreLeavesThanArrivesAndNearlyAllWhenSmooth",
    .defects = {{{"radiance taken for energy", "Furnace.DefectsAreRejected"},
                 {"refraction without 1 - F", "Furnace.DefectsAreRejected"},
                 {"reflection without F", "Furnace.DefectsAreRejected"}}}};

inline constexpr LedgerEntry kLights{
    .name = "paths/lights: integrals",
    .catches =
        "a density that is not the one of the sample: missing cosine, area, choice of emitter",
    .alpha = 4e-6,
    .comparisons = 6,
    .seed = 5003,
    .tests = "LightSampling.IntegratesLikeUniformDirections",
    .defects = {{{"light 3 % brighter", "LightSampling.IntegratesLikeUniformDirections"},
                 {"light 3 % larger", "LightSampling.IntegratesLikeUniformDirections"}}}};

inline constexpr LedgerEntry kLateLights{
    .name = "paths/lights: integrals of cylinders and textures",
    .catches = "the same of a cylinder, and a texture of an area light read in another place",
    .alpha = 1e-7,
    .comparisons = 4,
    .seed = 5103,
    .tests = "LightSampling.IntegratesLikeUniformDirections",
    .defects = {{{"light 5 % larger", "LightSampling.IntegratesLikeUniformDirections"}}}};

inline constexpr LedgerEntry kLateLightDensity{
    .name = "paths/light_density: cylinders and textures",
    .catches = "directions to a cylinder or a textured light that do not follow their density",
    .alpha = 1e-7,
    .comparisons = 6,
    .seed = 15100,
    .thorough = 2,
    .tests = "LightDensity.OfRandomPositionsIsThatOfTheDraws",
    .defects = {{{"density of a light 10 % larger or turned",
                  "LightDensity.OfRandomPositionsIsThatOfTheDraws"}}}};

inline constexpr LedgerEntry kLightDensity{
    .name = "paths/light_density",
    .catches = "directions to a light that do not follow the stated density, from any position",
    .alpha = 2e-6,
    .comparisons = 12,
    .seed = 15000,
    .thorough = 2,
    .tests = "LightDensity.OfRandomPositionsIsThatOfTheDraws",
    .defects = {{{"density of a light 10 % larger or turned",
                  "LightDensity.OfRandomPositionsIsThatOfTheDraws"}}}};

inline constexpr LedgerEntry kRandomDiffuseSampling{
    .name = "paths/diffuse_sampling",
    .catches =
        "a diffuse surface that does not follow its density as the renderer draws it: one-sided or "
        "two-sided, seen from any side, grazing",
    .alpha = 1e-7,
    .comparisons = 12,
    .seed = 19000,
    .thorough = 2,
    .tests = "DiffuseSampling.OfAnySurfaceFollowsItsDensity",
    .defects = {{{"density of the other side", "DiffuseSampling.OfAnySurfaceFollowsItsDensity"},
                 {"density without its cosine", "DiffuseSampling.OfAnySurfaceFollowsItsDensity"}}}};

inline constexpr LedgerEntry kSelectionChoices{
    .name = "paths/light_selection: choices",
    .catches = "emitters that are not chosen as often as stated, a density without the choice",
    .alpha = 1e-7,
    .comparisons = 8,
    .seed = 16100,
    .tests = "Selection.FollowsTheProbabilityThatItStates",
    .defects = {
        {{"frequencies of the uniform choice", "Selection.FollowsTheProbabilityThatItStates"},
         {"density of the uniform choice", "Selection.FollowsTheProbabilityThatItStates"}}}};

inline constexpr LedgerEntry kSelectionImages{
    .name = "paths/light_selection: images",
    .catches = "an image that depends on how its lights are chosen",
    .alpha = 1e-7,
    .comparisons = 5,
    .seed = 16200,
    .tests = "SelectionImages.AreTheSame",
    .defects = {
        {{"density of the uniform choice for BSDF samples", "SelectionImages.AreTheSame"}}}};

inline constexpr LedgerEntry kFilmConstant{
    .name = "render/film: constant image",
    .catches = "normalisation by realised weights, a border that is not clipped",
    .alpha = 4e-6,
    .comparisons = 6,
    .seed = 6100,
    .tests = "Film.ConstantImageStaysConstantAtTheBorderToo",
    .defects = {{{"normalisation that forgets the border",
                  "Film.ConstantImageStaysConstantAtTheBorderToo"}}}};

inline constexpr LedgerEntry kConformance{
    .name = "render/image: conformance scenes",
    .catches =
        "any difference of camera, film, textures, materials, lights, normals from the "
        "reference",
    .alpha = 6e-6,
    .comparisons = 43,
    .seed = 7000,
    .tests = "ConformanceImage.AgreesWithTheReference",
    .defects = {{{"light 1.5 % brighter", "ConformanceImageDefect.LightTooBright"},
                 {"field of view 1 % wider", "ConformanceImageDefect.FieldOfViewTooWide"},
                 {"texture upside down", "ConformanceImageDefect.TextureUpsideDown"},
                 {"roughness 10 % larger", "ConformanceImageDefect.MaterialTooRough"},
                 {"sky turned by 3 degrees", "ConformanceImageDefect.SkyTurned"},
                 {"bumps 10 % higher", "ConformanceImageDefect.BumpsTooHigh"}}}};

inline constexpr LedgerEntry kOtherScenes{
    .name = "render/image: scenes beyond the list",
    .catches = "the same in scenes of another reference folder",
    .alpha = 1e-7,
    .comparisons = 1,
    .seed = 7000,
    .tests = "ConformanceImages.SceneOfTheFolderThatLoadsAgreesToo",
    .needs_data = true};

inline constexpr LedgerEntry kAlpha{
    .name = "render/image: alpha",
    .catches = "a share of surfaces in a pixel that is not the reference's",
    .alpha = 1e-7,
    .comparisons = 1,
    .seed = 7100,
    .tests = "Alpha.AgreesWithTheReference",
    .defects = {{{"sphere 2 % larger", "Alpha.AgreesWithTheReference"}}}};

inline constexpr LedgerEntry kPublishedImages{
    .name = "render/image: published scenes",
    .catches = "the same at full complexity, at the true texture and at 0.5",
    .alpha = 3e-6,
    .comparisons = 6,
    .seed = 7000,
    .thorough = 2,
    .tests = "PublishedImage.AgreesWithTheReference",
    .needs_data = true};

inline constexpr LedgerEntry kSelection{
    .name = "gradient/reservoir: selection",
    .catches = "selection that is not in proportion to the weight",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 101,
    .tests = "Reservoir.KeepsASampleInProportionToItsWeight",
    .defects = {
        {{"keep with probability w / w_old", "Reservoir.KeepsASampleInProportionToItsWeight"}}}};

inline constexpr LedgerEntry kFreshReservoir{
    .name = "gradient/reservoir: E[f W] of fresh candidates",
    .catches = "the same, seen in the estimate",
    .alpha = 3e-6,
    .comparisons = 6,
    .seed = 301,
    .tests = "Reservoir.EstimateIsUnbiasedBeforeMerging",
    .defects = {
        {{"keep with probability w / w_old", "Reservoir.EstimateIsUnbiasedBeforeMerging"}}}};

inline constexpr LedgerEntry kChain{
    .name = "gradient/reservoir: chained merges",
    .catches =
        "bias after merging, while the target flips its sign, its zeros move and most iterations "
        "have no candidate",
    .alpha = 4e-6,
    .comparisons = 4,
    .seed = 201,
    .tests = "Merge.IsUnbiasedAtEveryIterationWhileTheTargetFlipsItsSign",
    .defects = {{{"merge keeps with w / w_old", "Merge.DefectsOfTheChainAreRejected"},
                 {"M counted per hit", "Merge.DefectsOfTheChainAreRejected"},
                 {"confidence per sign", "Merge.DefectsOfTheChainAreRejected"},
                 {"history dropped where its sign flipped", "Merge.DefectsOfTheChainAreRejected"},
                 {"W rescaled by a ratio of densities", "Merge.DefectsOfTheChainAreRejected"},
                 {"weights that are constant", "Merge.DefectsOfTheChainAreRejected"}}}};

inline constexpr LedgerEntry kVariance{
    .name = "gradient/reservoir: variance",
    .catches =
        "lost positivisation: variance of `pris` falls as 1 / M, that of `ris` stops at "
        "V[f / \\|f\\|*]",
    .alpha = 3e-6,
    .comparisons = 3,
    .seed = 501,
    .tests =
        "Variance.OfPositivisedResamplingFallsAsOneOverM|"
        "Variance.OfResamplingWithAbsoluteTargetStopsAtItsFloor",
    .defects = {
        {{"ris in place of pris", "Variance.OfPositivisedResamplingFallsAsOneOverM"},
         {"pris in place of ris", "Variance.OfResamplingWithAbsoluteTargetStopsAtItsFloor"}}}};

inline constexpr LedgerEntry kEstimators{
    .name = "gradient/estimators: expectation",
    .catches = "bias of any estimator x shift x target x merge rule, at any of six iterations",
    .alpha = 6e-6,
    .comparisons = 22,
    .seed = 1000,
    .tests = "Estimators.AgreeWithTheBaselineAtEveryIteration",
    .defects = {{{"W divided by a wrong M", "Estimators.DefectsAreRejected"},
                 {"history dropped where the adjoint flips", "Estimators.DefectsAreRejected"},
                 {"stale q of the iteration before", "Estimators.DefectsAreRejected"},
                 {"reservoirs lost, their confidence kept", "Estimators.DefectsAreRejected"},
                 {"gradient 10 % larger", "Estimators.DefectsAreRejected"}}}};

inline constexpr LedgerEntry kResampledLights{
    .name = "gradient/estimators: resampled lights",
    .catches =
        "bias of `pgris` where light samples are resampled, from candidates of each emitter or of "
        "some, at any of six iterations",
    .alpha = 1e-7,
    .comparisons = 4,
    .seed = 110000,
    .tests = "ResampledLights.GiveReservoirsTheExpectationOfUniformOnes",
    .defects = {{{"gradient a quarter larger",
                  "ResampledLights.GiveReservoirsTheExpectationOfUniformOnes"}}}};

inline constexpr LedgerEntry kAdaptiveSampling{
    .name = "gradient/adaptive_sampling: expectation",
    .catches =
        "bias of an estimator whose samples are spent where pixels matter most, at any of six "
        "iterations",
    .alpha = 1e-7,
    .comparisons = 5,
    .seed = 50000,
    .tests = "AdaptiveSampling.EstimatorsAgreeWithTheBaselineAtEveryIteration",
    .defects = {{{"all samples count alike",
                  "AdaptiveSampling.EstimatorsAgreeWithTheBaselineAtEveryIteration"},
                 {"samples divided by how many came",
                  "AdaptiveSampling.EstimatorsAgreeWithTheBaselineAtEveryIteration"},
                 {"pixels left out that see a texture",
                  "AdaptiveSampling.EstimatorsAgreeWithTheBaselineAtEveryIteration"}}}};

inline constexpr LedgerEntry kVarianceRatios{
    .name = "gradient/variance: ratios",
    .catches =
        "history, positivisation, cached passes or a choice of pixels that are lost: they cost "
        "variance, not bias",
    .alpha = 4e-7,
    .comparisons = 4,
    .seed = 55000,
    .tests =
        "Variances.AreLessWithReuseAndPositivisation|Variances.AreLessWithAPathCache|"
        "VariancesOfOneHalf.AreLessWithAdaptiveSampling",
    .defects = {
        {{"history lost", "Variances.AreLessWithReuseAndPositivisation"},
         {"one slot for both signs", "Variances.AreLessWithReuseAndPositivisation"},
         {"a window of one pass", "Variances.AreLessWithAPathCache"},
         {"as many samples in every pixel", "VariancesOfOneHalf.AreLessWithAdaptiveSampling"}}}};

inline constexpr LedgerEntry kSlope{
    .name = "gradient/estimators: slope",
    .catches = "a gradient that is not the slope of the image",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 0,
    .tests = "Baseline.IsTheSlopeOfTheRenderedImage",
    .defects = {{{"gradient 10 % larger", "Baseline.IsTheSlopeOfTheRenderedImage"}}}};

inline constexpr LedgerEntry kStreams{
    .name = "gradient/estimators: streams",
    .catches = "an image and a derivative that are correlated",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 7000,
    .tests = "Streams.ImageAndDerivativeMustNotShareTheirSamples",
    .defects = {{{"one stream for image and derivative",
                  "Streams.ImageAndDerivativeMustNotShareTheirSamples"}}}};

inline constexpr LedgerEntry kFilmGradient{
    .name = "gradient/estimators: film",
    .catches = "w(x) that is normalised by realised filter weights",
    .alpha = 1e-6,
    .comparisons = 1,
    .seed = 9000,
    .tests = "Film.RealisedWeightsWouldBiasTheGradient",
    .defects = {
        {{"normalisation by realised weights", "Film.RealisedWeightsWouldBiasTheGradient"}}}};

inline constexpr LedgerEntry kClosedImages{
    .name = "gradient/closed_form: images",
    .catches =
        "a wrong constant, cosine, distance law or form factor anywhere between the scene and "
        "the image",
    .alpha = 3e-6,
    .comparisons = 3,
    .seed = 6500,
    .tests = "ClosedForm",
    .defects = {{{"sky occluded by 1 %", "ClosedForm.ConvexBodyUnderAConstantSkyShowsRhoTimesLe"},
                 {"cosine left out", "ClosedForm.PointLightObeysTheInverseSquareAndTheCosine"},
                 {"lamp 1 % higher", "ClosedForm.PointLightObeysTheInverseSquareAndTheCosine"},
                 {"rectangle 2 % longer", "ClosedForm.RectangleLightObeysItsFormFactor"}}}};

inline constexpr LedgerEntry kClosedGradients{
    .name = "gradient/closed_form: derivatives",
    .catches = "the same in the derivative, of `mc` and of `pgris` with history",
    .alpha = 3e-6,
    .comparisons = 6,
    .seed = 6700,
    .tests = "ClosedForm.DerivativesByReflectanceAreTheIrradianceOverPi",
    .defects = {{{"value taken for the derivative",
                  "ClosedForm.DerivativesByReflectanceAreTheIrradianceOverPi"}}}};

inline constexpr LedgerEntry kIntegratingSphere{
    .name = "gradient/bounces: integrating sphere",
    .catches = "light lost or gained at any bounce, by Russian roulette too; its derivative",
    .alpha = 1e-7,
    .comparisons = 3,
    .seed = 6900,
    .tests = "IntegratingSphere",
    .defects = {
        {{"five bounces instead of all", "IntegratingSphere.ShowsAllOfItsBounces"},
         {"derivatives without further vertices", "IntegratingSphere.HasTheDerivativesOfItsSeries"},
         {"vertices of kept paths scatter twice",
          "IntegratingSphere.HasTheDerivativesOfItsSeriesInKeptPaths"}}}};

inline constexpr LedgerEntry kBounces{
    .name = "gradient/bounces: estimators",
    .catches =
        "bias of reservoirs where light bounces, at any of six iterations of a script: `pris`, "
        "`gris` and `pgris`, and `pgris` with adaptive samples and resampled lights",
    .alpha = 1e-7,
    .comparisons = 7,
    .seed = 6950,
    .tests = "Bounces.EstimatorsAgreeWithTheBaselineAtEveryIterationOfAScript",
    .defects = {{{"history takes the next vertex",
                  "Bounces.EstimatorsAgreeWithTheBaselineAtEveryIterationOfAScript"},
                 {"gradient a quarter larger",
                  "Bounces.EstimatorsAgreeWithTheBaselineAtEveryIterationOfAScript"}}}};

inline constexpr LedgerEntry kColoredBounces{
    .name = "gradient/bounces: light and textures without a common channel",
    .catches = "a target function that is positive where no history can hold the path",
    .alpha = 1e-7,
    .comparisons = 3,
    .seed = 6970,
    .tests = "Bounces.EstimatorsAgreeAfterTexturesThatLetNoLightThrough",
    .defects = {{{"vertices of kept paths scatter twice, coloured",
                  "Bounces.EstimatorsAgreeAfterTexturesThatLetNoLightThrough"}}}};

inline constexpr LedgerEntry kBouncesInCache{
    .name = "gradient/path_cache: expectation where light bounces",
    .catches = "bias of chains that are shaded under other textures than they were traced under",
    .alpha = 1e-7,
    .comparisons = 2,
    .seed = 46000,
    .tests = "PathCache.AgreesWithTheBaselineWhereLightBounces",
    .defects = {{{"adjoint of the half's own image, bounced",
                  "PathCache.AgreesWithTheBaselineWhereLightBounces"},
                 {"gradient 10 % larger", "PathCache.AgreesWithTheBaselineWhereLightBounces"}}}};

inline constexpr LedgerEntry kBlends{
    .name = "gradient/blends: direct light",
    .catches = "bias of any estimator in the derivative by the weight of a blend or by opacity",
    .alpha = 1e-6,
    .comparisons = 16,
    .seed = 47000,
    .tests = "BlendEstimators.HaveTheSlopesOfTheImageOfDirectLight",
    .defects = {{{"derivative 10 % larger", "BlendEstimators.HaveTheSlopesOfTheImageOfDirectLight"},
                 {"derivative with the other sign",
                  "BlendEstimators.HaveTheSlopesOfTheImageOfDirectLight"}}}};

inline constexpr LedgerEntry kBouncedBlends{
    .name = "gradient/blends: light that bounces",
    .catches = "the same where light bounces",
    .alpha = 1e-6,
    .comparisons = 16,
    .seed = 47500,
    .tests = "BlendEstimators.HaveTheSlopesOfTheImageWhereLightBounces",
    .defects = {
        {{"derivative 10 % larger", "BlendEstimators.HaveTheSlopesOfTheImageWhereLightBounces"},
         {"derivative with the other sign",
          "BlendEstimators.HaveTheSlopesOfTheImageWhereLightBounces"}}}};

inline constexpr LedgerEntry kPathCache{
    .name = "gradient/path_cache: expectation",
    .catches =
        "bias of the gradient of two halves of cached records, at any of six iterations of a "
        "script, "
        "noise of its images included, of either sequence of numbers",
    .alpha = 2e-6,
    .comparisons = 5,
    .seed = 40000,
    .tests = "PathCache.AgreesWithTheBaselineAtEveryIterationOfAScript",
    .defects = {{{"adjoint of the half's own image",
                  "PathCache.AgreesWithTheBaselineAtEveryIterationOfAScript"},
                 {"derivatives at the textures before",
                  "PathCache.AgreesWithTheBaselineAtEveryIterationOfAScript"},
                 {"image without its background",
                  "PathCache.AgreesWithTheBaselineAtEveryIterationOfAScript"}}}};

inline constexpr LedgerEntry kFiltersAndLosses{
    .name = "gradient/filters_losses",
    .catches = "bias of an estimator x shift x target under one of the filters and losses",
    .alpha = 6e-6,
    .comparisons = 36,
    .seed = 20000,
    .thorough = 2,
    .tests = "FiltersAndLosses.EveryEstimatorAgreesWithTheBaseline",
    .defects = {{{"q of the history without the filter's normalisation",
                  "FiltersAndLossesDefect.HistoryUnderAnotherNormalisationIsRejected"}}}};

inline constexpr LedgerEntry kReuseInALoop{
    .name = "gradient/reuse_in_a_loop: script",
    .catches = "bias of reuse along the textures and adjoints of a run that other samples made",
    .alpha = 2e-6,
    .comparisons = 2,
    .seed = 30000,
    .thorough = 2,
    .tests = "ReuseInALoop.IsBiasedAndAlongAScriptIsNot",
    .defects = {
        {{"textures moved by the reused samples", "ReuseInALoop.IsBiasedAndAlongAScriptIsNot"}}}};

inline constexpr LedgerEntry kIterations{
    .name = "optimize/iteration: gradient",
    .catches =
        "a gradient of a whole iteration that is not the slope of the loss between converged "
        "images: any estimator, any kind of unknown, background, history, noise of the image",
    .alpha = 1e-7,
    .comparisons = 15,
    .seed = 70000,
    .thorough = 2,
    .tests = "Iteration.GradientIsTheSlopeOfTheLoss",
    .defects = {{{"gradient 10 % larger", "Iteration.GradientIsTheSlopeOfTheLoss"}}}};

inline constexpr LedgerEntry kManyReservoirs{
    .name = "optimize/iteration: many reservoirs",
    .catches = "the same where reservoirs come in many ranges and pixels in many batches",
    .alpha = 1e-7,
    .comparisons = 2,
    .seed = 75000,
    .thorough = 2,
    .tests = "Iteration.GradientOfManyReservoirsIsTheSlopeOfTheLoss",
    .defects = {{{"history of the first range alone",
                  "Iteration.GradientOfManyReservoirsIsTheSlopeOfTheLoss"}}}};

inline constexpr LedgerEntry kFittedExposures{
    .name = "optimize/iteration: fitted exposures",
    .catches =
        "an exposure that is not the one that converged images have, a gradient at it that is not "
        "the slope of the loss there: noise of the images, their background",
    .alpha = 1e-7,
    .comparisons = 14,
    .seed = 76000,
    .thorough = 2,
    .tests = "Iteration.GradientAtAFittedExposureIsTheSlopeOfTheFittedLoss",
    .defects = {{{"gradient at an exposure 8 % too small",
                  "Iteration.GradientAtAFittedExposureIsTheSlopeOfTheFittedLoss"},
                 {"exposure 1.2 % too small",
                  "Iteration.GradientAtAFittedExposureIsTheSlopeOfTheFittedLoss"}}}};

inline constexpr LedgerEntry kReweighted{
    .name = "optimize/iteration: reweighted pixels",
    .catches =
        "pixels that are weighed by an image of the same samples: a gradient that noise moves "
        "where the image is the target",
    .alpha = 1e-7,
    .comparisons = 4,
    .seed = 77000,
    .thorough = 2,
    .tests = "Iteration.GradientOfReweightedPixelsIsZeroAtTheTarget",
    .defects = {{{"weights of the same samples",
                  "Iteration.GradientOfReweightedPixelsIsZeroAtTheTarget"}}}};

inline constexpr LedgerEntry kSummaryLosses{
    .name = "optimize/summary: losses",
    .catches = "a loss at the start, or a noise floor, that noise moves",
    .alpha = 1e-7,
    .comparisons = 2,
    .seed = 78000,
    .tests = "Summary.LossesHoldNoNoiseOnAverage",
    .defects = {{{"loss of a noisy image", "Summary.LossesHoldNoNoiseOnAverage"},
                 {"half the noise floor", "Summary.LossesHoldNoNoiseOnAverage"}}}};

inline constexpr LedgerEntry kGateAtTruth{
    .name = "optimize/gate: at the truth",
    .catches =
        "halves of a path cache that depend on each other, whose gate takes noise for signal",
    .alpha = 1e-7,
    .comparisons = 2,
    .seed = 79000,
    .thorough = 2,
    .tests = "GateAtTheTruth.IsShutForHalfOfTheTexels",
    .defects = {{{"halves weighed by one image", "GateAtTheTruth.IsShutForHalfOfTheTexels"}}}};

inline constexpr LedgerEntry kBaselineGradients{
    .name = "gradient/gradients: baseline",
    .catches = "a wrong derivative of any parameter, any texel",
    .alpha = 3e-6,
    .comparisons = 4,
    .seed = 8000,
    .tests = "ReferenceGradients.OfTheBaselineAgreeInEveryTexel",
    .defects = {{{"one texel 10 % larger", "ReferenceGradientDefects.AreRejected"},
                 {"one parameter 10 % larger", "ReferenceGradientDefects.AreRejected"},
                 {"two channels exchanged", "ReferenceGradientDefects.AreRejected"}}}};

inline constexpr LedgerEntry kPgrisGradients{
    .name = "gradient/gradients: `pgris`",
    .catches = "bias of reuse at frozen textures",
    .alpha = 3e-6,
    .comparisons = 5,
    .seed = 8500,
    .thorough = 2,
    .tests =
        "ReferenceGradients.OfThePapersEstimatorAgreeInEveryTexel|"
        "ReferenceGradientsOfKeptPaths.AgreeInEveryTexel",
    .defects = {
        {{"gradient 10 % larger", "ReferenceGradients.OfThePapersEstimatorAgreeInEveryTexel"},
         {"gradient of kept paths 10 % larger",
          "ReferenceGradientsOfKeptPaths.AgreeInEveryTexel"}}}};

inline constexpr LedgerEntry kPublishedGradients{
    .name = "gradient/gradients: published scenes",
    .catches = "the same on the paper's textures, in blocks of 16 x 16 texels",
    .alpha = 3e-6,
    .comparisons = 3,
    .seed = 8600,
    .thorough = 2,
    .tests = "PublishedGradients.AgreeInEveryBlock",
    .needs_data = true};

inline constexpr LedgerEntry kConvergedError{
    .name = "experiments/trajectory: converged derivatives",
    .catches = "an error of a converged derivative that is not the one it has",
    .alpha = 1e-7,
    .comparisons = 1,
    .seed = 61000,
    .tests = "Reproduce.AConvergedDerivativeStatesItsOwnError",
    .defects = {{{"error of a half", "Reproduce.AConvergedDerivativeStatesItsOwnError"}}}};

inline constexpr LedgerEntry kMoreSamples{
    .name = "experiments/trajectory: error over samples",
    .catches =
        "samples that repeat each other: an error that does not fall as one over their number",
    .alpha = 1e-7,
    .comparisons = 1,
    .seed = 62000,
    .tests = "Reproduce.MoreSamplesComeNearerToTheConvergedDerivative",
    .defects = {{{"samples that repeat each other",
                  "Reproduce.MoreSamplesComeNearerToTheConvergedDerivative"}}}};

inline constexpr LedgerEntry kAlongTrajectory{
    .name = "experiments/trajectory: expectation",
    .catches = "an estimator that is not asked about the textures and adjoints of its script",
    .alpha = 1e-7,
    .comparisons = 2,
    .seed = 63000,
    .tests = "Reproduce.EstimatorsAgreeAtTheEndOfATrajectory",
    .defects = {
        {{"adjoint of another iteration", "Reproduce.EstimatorsAgreeAtTheEndOfATrajectory"}}}};

inline constexpr LedgerEntry kClosedLoop{
    .name = "experiments/closed_loop: bias",
    .catches = "gradients of the path cache that its own run biases at the default learning rate",
    .alpha = 1e-7,
    .comparisons = 1,
    .seed = 64000,
    .tests = "ClosedLoop.BiasOfThePathCacheIsBoundedAtTheDefaultRate",
    .defects = {
        {{"steps five times as long", "ClosedLoop.BiasOfThePathCacheIsBoundedAtTheDefaultRate"}}}};

inline constexpr LedgerEntry kTexelEvidence{
    .name = "texture/coverage: sensitivity",
    .catches = "a sensitivity of texels that is not the sum of squared derivatives of the pixels",
    .alpha = 2e-8,
    .comparisons = 1,
    .seed = 20500,
    .tests = "TexelEvidence.IsTheDiagonalOfTheGaussNewtonMatrix",
    .defects = {{{"squares of one sample", "TexelEvidence.IsTheDiagonalOfTheGaussNewtonMatrix"}}}};

}  // namespace burnish::test::ledger

namespace burnish::test {

/// In the order of the documentation.
inline constexpr const LedgerEntry* kLedger[] = {
    &ledger::kGoodnessOfFit,
    &ledger::kSkewedMeans,
    &ledger::kAliasTable,
    &ledger::kSobol,
    &ledger::kEnvironmentWeights,
    &ledger::kEnvironmentIntegral,
    &ledger::kRandomEnvironment,
    &ledger::kPrincipledSampling,
    &ledger::kPrincipledFloatSampling,
    &ledger::kRandomSampling,
    &ledger::kGrazingGlass,
    &ledger::kDiffuseSampling,
    &ledger::kFacetSampling,
    &ledger::kRandomFacetSampling,
    &ledger::kInterfaceSampling,
    &ledger::kInterfaceEnergy,
    &ledger::kFurnace,
    &ledger::kLights,
    &ledger::kLightDensity,
    &ledger::kLateLights,
    &ledger::kLateLightDensity,
    &ledger::kRandomDiffuseSampling,
    &ledger::kSelectionChoices,
    &ledger::kSelectionImages,
    &ledger::kFilmConstant,
    &ledger::kConformance,
    &ledger::kOtherScenes,
    &ledger::kAlpha,
    &ledger::kPublishedImages,
    &ledger::kSelection,
    &ledger::kFreshReservoir,
    &ledger::kChain,
    &ledger::kVariance,
    &ledger::kEstimators,
    &ledger::kResampledLights,
    &ledger::kAdaptiveSampling,
    &ledger::kVarianceRatios,
    &ledger::kSlope,
    &ledger::kStreams,
    &ledger::kFilmGradient,
    &ledger::kIntegratingSphere,
    &ledger::kBounces,
    &ledger::kColoredBounces,
    &ledger::kBouncesInCache,
    &ledger::kBlends,
    &ledger::kBouncedBlends,
    &ledger::kPathCache,
    &ledger::kFiltersAndLosses,
    &ledger::kReuseInALoop,
    &ledger::kClosedImages,
    &ledger::kClosedGradients,
    &ledger::kIterations,
    &ledger::kManyReservoirs,
    &ledger::kFittedExposures,
    &ledger::kReweighted,
    &ledger::kSummaryLosses,
    &ledger::kGateAtTruth,
    &ledger::kBaselineGradients,
    &ledger::kPgrisGradients,
    &ledger::kPublishedGradients,
    &ledger::kConvergedError,
    &ledger::kMoreSamples,
    &ledger::kAlongTrajectory,
    &ledger::kClosedLoop,
    &ledger::kTexelEvidence,
};

}  // namespace burnish::test
