# macula-server in a container. From the root of the source:
#   docker build -f deploy/docker/server.Dockerfile -t macula-server .
#   docker run --rm -p 7788:7788 -v macula-keys:/var/lib/macula macula-server --scene atrium
# Let a client in, beside the running server (the code is shown here, typed there):
#   docker run --rm -it -p 7789:7789 -v macula-keys:/var/lib/macula macula-server pair
FROM debian:12-slim AS build
COPY deploy/install.sh deploy/common.sh deploy/packages.txt /macula/deploy/
RUN /macula/deploy/install.sh build package
COPY . /macula
RUN cd /macula && ./deploy/package.sh --no-install

FROM debian:12-slim
COPY --from=build /macula/build/packages/macula-server_*.deb /tmp/
RUN apt-get update \
    && apt-get install -y --no-install-recommends /tmp/macula-server_*.deb \
    && rm -rf /var/lib/apt/lists/* /tmp/macula-server_*.deb \
    && install -d -o macula -g macula -m 0700 /var/lib/macula \
    && sed -i 's|^# bind = .*|bind = "tcp://*:7788"|' /etc/macula/server.toml
USER macula
VOLUME /var/lib/macula
EXPOSE 7788 7789
STOPSIGNAL SIGTERM
ENTRYPOINT ["macula-server", "--config", "/etc/macula/server.toml", "--keys", "/var/lib/macula"]
