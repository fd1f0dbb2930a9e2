// Which of two ways of drawing a camera gets: the batches of what is visible, or the loaded objects as they are.

import { Layers } from 'three';

/** The camera that the plugin has culled for, and none other: shared by all objects of a file. */
export class Route {
    /** Layers of that camera. @type {Layers | null} */
    active = null;
}

/** Layers of a loaded object that a batch draws for the active camera. Other cameras and rays find the object itself. */
export class ObjectLayers extends Layers {
    /**
     * @param {Route} route
     * @param {Layers} original
     */
    constructor(route, original) {
        super();
        this.mask = original.mask;
        this.route = route;
        /** Draw the object itself for the active camera, too. */
        this.drawn = false;
    }

    /** @param {Layers} layers */
    test(layers) {
        return (layers !== this.route.active || this.drawn) && super.test(layers);
    }

    /**
     * The layers have one in common, whatever draws the object.
     * @param {Layers} layers
     */
    matches(layers) {
        return super.test(layers);
    }
}

/** Layers of a batch: only the active camera sees it, and no ray does. */
export class BatchLayers extends Layers {
    /** @param {Route} route */
    constructor(route) {
        super();
        this.route = route;
    }

    /** @param {Layers} layers */
    test(layers) {
        return layers === this.route.active;
    }
}
