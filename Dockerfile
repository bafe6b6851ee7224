# thetahat with its engines: the command, the Python package, Dask and Ray.
#
#   docker build -t thetahat .
#   docker run --rm -v "$PWD":/work thetahat thetahat identify experiment.toml --out results
#   docker run --rm --network host thetahat dask worker tcp://SCHEDULER:8786 --nthreads 1
#
# Driver and workers take the same image: the names of parts contain the version of thetahat.
FROM rust:1.95-slim-bookworm AS build
# The compiler's version follows the base image.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends gcc libc6-dev python3 python3-venv \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /source
COPY . .
RUN python3 -m venv /maturin \
    && /maturin/bin/pip install --no-cache-dir "maturin>=1.9.4,<2" \
    && /maturin/bin/maturin build --release --locked --out /wheels

FROM python:3.12-slim-bookworm
COPY --from=build /wheels /wheels
# One wheel is there; its extras are what an engine and a store need.
RUN wheel=$(find /wheels -name '*.whl') \
    && pip install --no-cache-dir "thetahat[dask,ray,s3] @ file://$wheel" \
    && rm -r /wheels \
    && useradd --create-home --uid 1000 thetahat
USER 1000
WORKDIR /work
CMD ["thetahat", "--help"]
